#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <map>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "program_bench.hpp"

namespace metier::skill::testing {
namespace {

using namespace std::chrono_literals;

constexpr auto kConfigurationTimeout = 10'000ms;
constexpr auto kRestDeadline = 5'000ms;
constexpr auto kLease = 3001ms;  // odd, so that nothing else falls due at the same time

/// Events for a Program.
enum class Act {
    start,
    suspend,
    resume,
    halt,
    reset,
    start_with,
    acquire,
    heartbeat,
    release,
    write,
    write_badly,
    at_rest,
    finish,
    fail,
    late_call,
    owner_lost,
    device_lost,
    session_closed,
    wait,
};
constexpr int kActs = static_cast<int>(Act::wait) + 1;

struct Step {
    Act act;
    std::string session;
    double speed;
    std::chrono::milliseconds wait;
    OwnerLossAction on_owner_loss;  // of a start or a lease
};

/// The state machine of the model, written once more, as simply as can be.
class Model {
public:
    /// Whether the step is accepted; `transitions` grows by what it causes.
    bool take(const Step& step) {
        switch (step.act) {
            case Act::start:
                return start(step.session);
            case Act::suspend:
                return mayCommand(step.session) && suspend();
            case Act::resume:
                return mayCommand(step.session) && resume(step.session);
            case Act::halt:
                return halt();
            case Act::reset:
                return mayCommand(step.session) && reset();
            default:
                return command(step);
        }
    }

    State state = State::ready;
    SubState sub_state = SubState::ready_not_configured;
    double speed = 0.5;
    std::vector<std::string> transitions;

private:
    /// Command of a client, which may need control for it.
    bool command(const Step& step) {
        switch (step.act) {
            case Act::start_with:
                return startWith(step);
            case Act::acquire:
                return acquire(step);
            case Act::heartbeat:
                return leased_ == step.session ? (lease_left_ = kLease, true) : false;
            case Act::release:
                return leased_ == step.session ? (leased_.reset(), true) : false;
            case Act::write:
                return write(step.session, step.speed);
            case Act::write_badly:
                return false;
            default:
                happen(step);
                return true;
        }
    }

    bool isFree(const std::string& session) const { return !leased_ || leased_ == session; }
    bool mayCommand(const std::string& session) const {
        return isFree(session) && !stale_.contains(session);
    }
    bool startWith(const Step& step) {
        if (!start(step.session)) {
            return false;
        }
        on_owner_loss_ = step.on_owner_loss;
        return true;
    }
    bool acquire(const Step& step) {
        if (!isFree(step.session)) {
            return false;
        }
        stale_.erase(step.session);
        leased_ = step.session;
        lease_left_ = kLease;
        lease_action_ = step.on_owner_loss;
        return true;
    }
    void loseLease() {
        const auto session = *leased_;
        leased_.reset();
        if (bound_ == session) {
            endConfiguration();
        }
        if (owner_ == session) {
            loseOwner(lease_action_);
        }
    }
    void loseOwner(OwnerLossAction of_lease) {
        auto action = on_owner_loss_ != OwnerLossAction::skill_default ? on_owner_loss_ : of_lease;
        if (action == OwnerLossAction::skill_default) {
            action = OwnerLossAction::halt;
        }
        owner_.clear();
        if (action == OwnerLossAction::keep_going) {
            return;
        }
        if (state != State::running || halting_) {
            return;
        }
        if (action == OwnerLossAction::halt) {
            halting_ = SubState::halted_owner_lost;
            stop();
        } else if (sub_state != SubState::stopping) {
            stop();
        }
    }

    void go(State to, SubState sub) {
        transitions.push_back(std::string(toString(state)) + "To" + std::string(toString(to)));
        state = to;
        sub_state = sub;
        rest_left_.reset();
        halting_.reset();
        if (to != State::suspended) {
            done_ = false;
        }
        unbind();
    }
    void unbind() {
        bound_.reset();
        speed = 0.5;
    }
    bool start(const std::string& session) {
        if (state != State::ready || !mayCommand(session) || (bound_ && *bound_ != session)) {
            return false;
        }
        go(State::running, SubState::executing);
        owner_ = session;
        on_owner_loss_ = OwnerLossAction::skill_default;
        return true;
    }
    bool suspend() {
        if (sub_state != SubState::executing) {
            return false;
        }
        stop();
        return true;
    }
    void stop() {
        sub_state = SubState::stopping;
        rest_left_ = kRestDeadline;
    }
    bool resume(const std::string& session) {
        if (state != State::suspended) {
            return false;
        }
        const bool done = done_;
        if (owner_.empty()) {
            owner_ = session;
        }
        go(State::running, SubState::executing);
        if (done) {
            go(State::ready, SubState::ready_not_configured);
        }
        return true;
    }
    bool halt() {
        if (state == State::halted) {
            return false;
        }
        if (state != State::running) {
            go(State::halted, SubState::halted_by_client);
        } else if (!halting_) {
            halting_ = SubState::halted_by_client;
            stop();
        }
        return true;
    }
    bool reset() {
        if (state != State::halted && state != State::suspended) {
            return false;
        }
        go(State::ready, SubState::ready_not_configured);
        return true;
    }
    bool write(const std::string& session, double value) {
        if (state != State::ready || !mayCommand(session) || (bound_ && *bound_ != session)) {
            return false;
        }
        bound_ = session;
        bound_left_ = kConfigurationTimeout;
        speed = value;
        sub_state = SubState::ready_configured;
        return true;
    }

    void happen(const Step& step) {
        if (step.act == Act::at_rest) {
            atRest();
        } else if (step.act == Act::finish) {
            finish();
        } else if (step.act == Act::fail && isExecuting()) {
            go(State::halted, SubState::halted_force);
        } else if (step.act == Act::owner_lost) {
            loseOwner(OwnerLossAction::skill_default);
        } else if (step.act == Act::device_lost && state == State::halted) {
            sub_state = SubState::halted_device_lost;
        } else if (step.act == Act::device_lost) {
            go(State::halted, SubState::halted_device_lost);
        } else if (step.act == Act::session_closed) {
            closeSession(step.session);
        } else if (step.act == Act::wait) {
            wait(step.wait);
        }
    }
    void closeSession(const std::string& session) {
        if (leased_ == session) {
            loseLease();
        }
        if (bound_ == session) {
            endConfiguration();
        }
        if (owner_ == session) {
            loseOwner(OwnerLossAction::skill_default);
        }
        stale_.erase(session);
    }
    bool isExecuting() const { return state == State::running || state == State::suspended; }
    void atRest() {
        if (sub_state != SubState::stopping) {
            return;
        }
        if (halting_) {
            go(State::halted, *halting_);
        } else {
            go(State::suspended, SubState::none);
        }
    }
    void finish() {
        if (state == State::suspended) {
            done_ = true;
        } else if (state == State::running && halting_) {
            go(State::halted, *halting_);
        } else if (state == State::running) {
            go(State::ready, SubState::ready_not_configured);
        }
    }
    void endConfiguration() {
        unbind();
        sub_state = SubState::ready_not_configured;
    }
    /// A stretch of time, with what falls due in it in its order.
    void wait(std::chrono::milliseconds time) {
        if (leased_ && lease_left_ <= time) {
            const auto until = lease_left_;
            pass(until);
            stale_.insert(*leased_);
            loseLease();
            pass(time - until);
        } else {
            lease_left_ -= time;
            pass(time);
        }
    }
    void pass(std::chrono::milliseconds time) {
        if (bound_) {
            bound_left_ -= time;
            if (bound_left_ <= 0ms) {
                endConfiguration();
            }
        }
        if (rest_left_) {
            *rest_left_ -= time;
            if (*rest_left_ <= 0ms) {
                const bool owner_lost = halting_ == SubState::halted_owner_lost;
                go(State::halted,
                   owner_lost ? SubState::halted_owner_lost : SubState::halted_error);
            }
        }
    }

    std::optional<std::string> bound_;
    std::chrono::milliseconds bound_left_{0};
    std::optional<std::chrono::milliseconds> rest_left_;
    std::optional<SubState> halting_;
    bool done_ = false;
    std::string owner_;
    OwnerLossAction on_owner_loss_ = OwnerLossAction::skill_default;
    std::optional<std::string> leased_;
    std::set<std::string> stale_;
    std::chrono::milliseconds lease_left_{0};
    OwnerLossAction lease_action_ = OwnerLossAction::skill_default;
};

/// Applies the steps of the Model to a Program.
class Walker {
public:
    bool take(const Step& step) {
        const bool accepted = tell(step);
        bench_.run();
        return accepted;
    }
    const ProgramBench& bench() const { return bench_; }

private:
    bool tell(const Step& step) {
        auto& program = *bench_.program;
        const Caller caller{step.session, {}, {}};
        if (step.act <= Act::reset) {
            const auto method = static_cast<Method>(step.act);
            const bool executable = program.executable(method, caller);
            earlier_ = bench_.script->execution;
            const bool accepted = bench_.call(method, caller).has_value();
            EXPECT_EQ(executable, accepted) << toString(method);
            return accepted;
        }
        if (step.act == Act::start_with) {
            earlier_ = bench_.script->execution;
            return program.startWith(caller, {.on_owner_loss = step.on_owner_loss}).has_value();
        }
        if (step.act >= Act::acquire && step.act <= Act::release) {
            return lease(caller, step);
        }
        if (step.act == Act::write) {
            return program.write(caller, "Speed", step.speed).has_value();
        }
        if (step.act == Act::write_badly) {
            return program.write(caller, "Speed", step.speed + 10).has_value();
        }
        happen(step);
        return true;
    }
    bool lease(const Caller& caller, const Step& step) {
        if (step.act == Act::heartbeat) {
            return control_->heartbeat(caller, epochs_[caller.session_id]).has_value();
        }
        if (step.act == Act::release) {
            return control_->release(caller, epochs_[caller.session_id]).has_value();
        }
        const auto epoch = control_->acquire(caller, kLease, step.on_owner_loss);
        if (epoch) {
            epochs_[caller.session_id] = *epoch;
        }
        return epoch.has_value();
    }
    void happen(const Step& step) {
        const auto& execution = bench_.script->execution;
        if (step.act == Act::at_rest) {
            execution.atRest();
        } else if (step.act == Act::finish) {
            execution.finish();
        } else if (step.act == Act::fail) {
            execution.fail(Reason::force_exceeded, "31 N over 30 N");
        } else if (step.act == Act::late_call && earlier_.id() != execution.id()) {
            earlier_.fail(Reason::error, "late");
            earlier_.finish();
            earlier_.atRest();
        } else if (step.act == Act::owner_lost) {
            bench_.program->ownerLost("lease ran out");
        } else if (step.act == Act::device_lost) {
            bench_.program->deviceLost("cable pulled");
        } else if (step.act == Act::session_closed) {
            control_->sessionClosed(step.session);
            bench_.program->sessionClosed(step.session);
        } else if (step.act == Act::wait) {
            bench_.executor->advance(step.wait);
        }
    }

    std::shared_ptr<ManualExecutor> executor_ = std::make_shared<ManualExecutor>();
    std::shared_ptr<Control> control_ = std::make_shared<Control>(executor_, executor_->clock());
    ProgramBench bench_{{.control = control_,
                         .configuration_timeout = kConfigurationTimeout,
                         .rest_deadline = kRestDeadline},
                        weldDescription(),
                        executor_};
    ExecutionHandle earlier_;
    std::map<std::string, std::uint64_t> epochs_;
};

class RandomSteps {
public:
    explicit RandomSteps(std::uint32_t seed) : random_(seed) {}

    Step next() {
        static constexpr std::array<const char*, 3> sessions{"alice", "bob", "carol"};
        return {.act = static_cast<Act>(below(kActs)),
                .session = sessions.at(below(3)),
                .speed = 0.01 * below(200),
                .wait = std::chrono::milliseconds(below(4000)),
                .on_owner_loss = static_cast<OwnerLossAction>(below(4))};
    }

private:
    std::uint32_t below(std::uint32_t limit) {
        return std::uniform_int_distribution<std::uint32_t>(0, limit - 1)(random_);
    }

    std::mt19937 random_;
};

TEST(RandomWalk, OfAHundredThousandStepsFollowsTheModel) {
    constexpr int steps_to_take = 100'000;
    Walker walker;
    Model model;
    RandomSteps steps(20260701);
    const auto& program = *walker.bench().program;
    for (int i = 0; i < steps_to_take; ++i) {
        const auto step = steps.next();
        ASSERT_EQ(walker.take(step), model.take(step)) << "step " << i;
        ASSERT_EQ(program.state(), model.state) << "step " << i;
        ASSERT_EQ(program.subState(), model.sub_state) << "step " << i;
        ASSERT_EQ(program.read("Speed"), Value(model.speed)) << "step " << i;
        ASSERT_EQ(walker.bench().script->bodies_alive,
                  model.state == State::running || model.state == State::suspended ? 1 : 0)
            << "step " << i;
    }
    EXPECT_EQ(walker.bench().observer.transitions(), model.transitions);
    EXPECT_GT(model.transitions.size(), steps_to_take / 20U);
}

TEST(RandomWalk, LeavesNoGapBetweenItsEvents) {
    Walker walker;
    RandomSteps steps(7);
    for (int i = 0; i < 20'000; ++i) {
        walker.take(steps.next());
    }
    auto expected_from = State::ready;
    for (const auto& event : walker.bench().observer.events) {
        ASSERT_EQ(event.from, expected_from);
        ASSERT_EQ(fromState(event.number), event.from);
        ASSERT_EQ(toState(event.number), event.to);
        expected_from = event.to;
    }
}

}  // namespace
}  // namespace metier::skill::testing
