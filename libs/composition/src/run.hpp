#pragma once

#include <chrono>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "activity.hpp"
#include "metier/base/clock.hpp"
#include "metier/composition/composition.hpp"
#include "metier/composition/sequence_skill.hpp"
#include "metier/skill/execution_handle.hpp"
#include "metier/skill/executor.hpp"
#include "reset_round.hpp"
#include "scope.hpp"

namespace metier::composition {

class CallActivity;

/// A time that does not pass while the Run is held.
class StepTimer {
public:
    explicit StepTimer(Run& run) : run_(run) {}
    ~StepTimer() { cancel(); }
    StepTimer(const StepTimer&) = delete;
    StepTimer& operator=(const StepTimer&) = delete;

    void start(std::chrono::nanoseconds delay, std::function<void()> due);
    void cancel();
    /// Whether it is still to come due.
    bool running() const noexcept { return due_ != nullptr; }

private:
    friend class Run;
    void pause();
    void go();

    Run& run_;
    std::chrono::nanoseconds remaining_{0};
    SteadyTime since_{};
    bool running_ = false;
    std::function<void()> due_;
    skill::Timer timer_;
};

/// Setup of one execution of a composed skill.
struct RunSetup {
    const Composition& composition;
    BoundSkills& used;
    std::shared_ptr<skill::Executor> executor;
    const Clock& clock;
    const std::string& origin;
};

/// One execution of a composed skill: the tree of its steps under way.
///
/// While it is held nothing new begins; what is due waits in its order.
/// Threading: the owner's thread.
class Run {
public:
    Run(RunSetup setup, skill::ValueMap parameters);
    ~Run();
    Run(const Run&) = delete;
    Run& operator=(const Run&) = delete;

    void start(skill::ExecutionHandle execution);
    void suspend();
    /// Errors: what the first skill to resume refuses with; then all stay at rest.
    Result<void> resume();
    void halt();
    void forceStop() noexcept;

    // For activities.

    /// Does `work`, and all that follows from it.
    void enter(const std::function<void()>& work);
    /// Does `work` after the call that is under way.
    void later(std::function<void()> work) { due_.push_back(std::move(work)); }
    /// Does `work` in a later turn of the thread, so that others get theirs.
    void nextTurn(std::function<void()> work);
    bool held() const noexcept { return held_; }
    Scope& scope() noexcept { return scope_; }
    BoundSkill& used(const std::string& alias) { return setup_.used.find(alias)->second; }
    skill::Timer after(std::chrono::nanoseconds delay, std::function<void()> due);
    std::chrono::nanoseconds restTime() const { return setup_.composition.definition.rest_time; }
    skill::OwnerLossAction onOwnerLoss() const {
        return setup_.composition.definition.on_owner_loss;
    }
    /// A step has finished. \param time that it took
    void finished(const std::string& path, std::chrono::nanoseconds time);
    SteadyTime now() const { return setup_.clock.now(); }
    /// Makes the start of a used skill's next execution: gives it an id, and reports it to the
    /// observers of this one.
    skill::StartRequest stepExecution(const std::string& step, const UsedSkill& used);
    void attach(CallActivity& call) { calls_.push_back(&call); }
    /// Somebody else has suspended a used skill: the whole follows. \param why for a person
    void suspendedByOther(std::string why) { execution_.suspend(std::move(why)); }
    void detach(CallActivity& call) { std::erase(calls_, &call); }

private:
    friend class StepTimer;

    void drain();
    void report();
    std::string stepNames() const;
    void checkRest();
    void restTimePassed();
    void ended(Outcome outcome);
    void finish();

    RunSetup setup_;
    Scope scope_;
    skill::ExecutionHandle execution_;
    std::deque<std::function<void()>> due_;
    bool draining_ = false;
    bool held_ = false;
    bool suspending_ = false;
    bool halting_ = false;
    bool over_ = false;
    bool tidying_ = false;                // over, but for what it has halted itself
    std::optional<StepFailure> gave_up_;  // because something did not come to rest
    std::uint64_t begun_ = 0;
    std::vector<std::string> finished_;  // paths
    std::vector<double> times_;          // their times [s]
    std::string reported_step_;
    double published_progress_ = -1.0;
    std::vector<CallActivity*> calls_;
    std::vector<StepTimer*> timers_;
    skill::Timer rest_timer_;
    std::unique_ptr<Activity> root_;
    ResetRound resets_{*this, [this] { finish(); }};
    // Posted work asks it whether this is still there.
    std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);
};

}  // namespace metier::composition
