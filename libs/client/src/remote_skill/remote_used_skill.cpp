#include "remote_skill/remote_used_skill.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <utility>

namespace metier::client {

using client::AsyncSkill;
using composition::UsedSkillListener;
using skill::Method;
using skill::Reason;
using skill::State;
using skill::TransitionNumber;

namespace {

using composition::ClockOffset;
using std::chrono::duration_cast;
using std::chrono::nanoseconds;

constexpr int kQuestions = 10;
constexpr const char* kResetMeanwhile = "it was reset while it was suspended";
constexpr const char* kResetSinceHalted = "it was halted, and reset since by another client";
const opcua::NodeId kCurrentTime(0, 2258U);  // Server/ServerStatus/CurrentTime

// Longer than a composed skill asks the skills that it uses.
constexpr auto kLongestUsedCheck = std::chrono::seconds(15);
constexpr auto kUsedCheckPause = std::chrono::milliseconds(10);

/// Places of arms as the server at `url` names them. The arms of this server have no address.
skill::ArmPositions seenThere(const skill::ArmPositions& arms, const std::string& url) {
    skill::ArmPositions seen;
    for (const auto& [server, place] : arms) {
        if (!server.empty()) {
            seen.emplace(server == url ? std::string() : server, place);
        }
    }
    return seen;
}

/// Places of arms that the server at `url` has named.
skill::ArmPositions seenHere(const skill::ArmPositions& arms, const std::string& url) {
    skill::ArmPositions seen;
    for (const auto& [server, place] : arms) {
        seen.emplace(server.empty() ? url : server, place);
    }
    return seen;
}

Result<ClockOffset> askTime(opcua::Client& client) {
    const auto sent = std::chrono::steady_clock::now();
    const auto sent_utc = std::chrono::system_clock::now();
    const auto answer = client.read(kCurrentTime);
    const auto half = duration_cast<nanoseconds>(std::chrono::steady_clock::now() - sent) / 2;
    if (!answer) {
        return fail(answer.error());
    }
    const auto time = answer->as<UtcTime>();
    if (!time) {
        return fail(Errc::type_mismatch, "ServerStatus/CurrentTime is not a UtcTime");
    }
    return ClockOffset{duration_cast<nanoseconds>(*time - sent_utc) - half, half};
}

/// Asks a server for its time, several times, and trusts the quickest answer: its clock was read
/// within that round trip, so half of it is the uncertainty. Waits for the server.
Result<ClockOffset> clockOffsetOf(opcua::Client& client) {
    METIER_ASSIGN(auto best, askTime(client));
    for (int i = 1; i < kQuestions; ++i) {
        METIER_ASSIGN(const auto offset, askTime(client));
        best = offset.uncertainty < best.uncertainty ? offset : best;
    }
    return best;
}

}  // namespace

RemoteUsedSkill::RemoteUsedSkill(Connection& connection, std::shared_ptr<UsedSkillLink> link,
                                 std::string name, std::string origin)
    : connection_(connection),
      link_(std::move(link)),
      name_(std::move(name)),
      origin_(std::move(origin)) {
    link_->attach(this);
}

RemoteUsedSkill::~RemoteUsedSkill() {
    link_->attach(nullptr);
    drop();
}

/// To end a subscription, or a client, takes time: that is for the connection's thread.
void RemoteUsedSkill::drop() {
    if (skill_) {
        connection_.run([skill = std::move(skill_)]() mutable { skill.reset(); });
    }
}

Result<void> RemoteUsedSkill::available() const {
    return skill_ ? Result<void>{} : fail(Errc::connection_lost, lost_);
}

bool RemoteUsedSkill::isOurs(const std::string& execution) const {
    return execution.starts_with(origin_ + "/") || execution.starts_with(origin_ + "~");
}

void RemoteUsedSkill::adopt(std::shared_ptr<OpenSkill> skill, const AsyncSkill::Now& now) {
    drop();
    skill_ = std::move(skill);
    description_ = skill_->skill.description();
    lacks_ = textOf(skill_->skill.lacks());
    runs_others_ = skill_->skill.runsOthers();
    state_ = now.state;
    reason_text_ = now.reason_text;
    const bool runs = state_ == State::running || state_ == State::suspended;
    const bool may_be_ours = std::exchange(may_run_on_, false);
    if (runs && (may_be_ours || isOurs(now.execution_id))) {
        spdlog::warn(
            "{}: {} is {} and nobody waits for it: it is halted", name_,
            may_be_ours ? "the execution of before the loss" : "execution " + now.execution_id,
            toString(state_));
        left_over_ = true;
        static_cast<void>(command(Method::halt));
    }
}

/// Takes the state that was read while nothing runs from here; all other changes come as events.
void RemoteUsedSkill::refresh(const AsyncSkill::Now& now) {
    if (skill_ && execution_.empty() && !reset_ && !left_over_) {
        state_ = now.state;
        reason_text_ = now.reason_text;
    }
}

void RemoteUsedSkill::lost(const std::string& why) {
    drop();
    lost_ = why;
    if (reset_) {
        tellReset(fail(Errc::connection_lost, why));
    }
    if (!execution_.empty()) {
        may_run_on_ = !lacks_.empty();
        endLost(why);
    }
}

void RemoteUsedSkill::check(const skill::CheckRequest& request, skill::CheckDone done) {
    const auto number = ++check_count_;
    checks_.emplace(number, OpenCheck{{request.parameters, seenThere(request.starts, serverUrl())},
                                      std::move(done),
                                      std::chrono::steady_clock::now() + kLongestUsedCheck});
    askCheck(number);
}

void RemoteUsedSkill::askCheck(std::uint64_t number) {
    const auto told = [link = link_, number](const opcua::Answer<skill::CheckReport>& answer) {
        link->post([number, answer](RemoteUsedSkill& used) { used.checked(number, answer); });
    };
    const auto sent = skill_ ? skill_->skill.check(checks_.at(number).request, told)
                             : opcua::failed(opcua::status::kBadConnectionClosed, lost_);
    if (!sent) {
        told(tl::unexpected(sent.error()));
    }
}

/// A skill that must ask others is asked again.
void RemoteUsedSkill::checked(std::uint64_t number,
                              const opcua::Answer<skill::CheckReport>& answer) {
    const auto open = checks_.find(number);
    if (!answer && answer.error().code == Errc::timeout &&
        answer.error().delivery == opcua::Failure::Delivery::answered &&
        std::chrono::steady_clock::now() < open->second.deadline) {
        open->second.pause = link_->after(kUsedCheckPause, [this, number] { askCheck(number); });
        return;
    }
    const auto done = std::move(open->second.done);
    checks_.erase(open);
    if (!answer) {
        done(fail(answer.error()));
        return;
    }
    auto report = *answer;
    report.ends = seenHere(report.ends, serverUrl());
    done(std::move(report));
}

void RemoteUsedSkill::compareClocks(std::function<void(Result<composition::ClockOffset>)> done) {
    connection_.run([skill = skill_, link = link_, lost = lost_, done = std::move(done)] {
        auto offset = skill ? clockOffsetOf(*skill->client)
                            : Result<composition::ClockOffset>(fail(Errc::connection_lost, lost));
        link->post([done, offset = std::move(offset)](RemoteUsedSkill& /*used*/) { done(offset); });
    });
}

void RemoteUsedSkill::begin(skill::StartRequest request, UsedSkillListener& listener) {
    listener_ = &listener;
    execution_ = request.execution_id;
    reported_ = State::running;
    request.parent.server = connection_.options().own_server;
    started_ = halt_wanted_ = suspend_wanted_ = left_over_ = missed_ = false;
    const auto sent =
        skill_
            ? skill_->skill.startWith(
                  request,
                  [link = link_, id = execution_](const opcua::Answer<std::string>& answer) {
                      link->post([id, answer](RemoteUsedSkill& used) { used.started(id, answer); });
                  })
            : opcua::failed(opcua::status::kBadConnectionClosed, lost_);
    if (!sent) {
        link_->post([id = execution_, text = sent.error().message](RemoteUsedSkill& used) {
            if (used.execution_ == id) {
                used.endLost(text);
            }
        });
    }
}

void RemoteUsedSkill::started(const std::string& id, const opcua::Answer<std::string>& answer) {
    if (id != execution_) {
        return;
    }
    if (answer) {
        started_ = true;
        if (halt_wanted_) {
            static_cast<void>(command(Method::halt));
        } else if (suspend_wanted_) {
            static_cast<void>(command(Method::suspend));
        }
        if (std::exchange(missed_, false)) {
            onMissed();
        }
        return;
    }
    const auto& failure = answer.error();
    if (failure.delivery != opcua::Failure::Delivery::answered) {
        haltIfRuns(id);
        endLost(failure.message);
        return;
    }
    withReason(failure.message, [id](RemoteUsedSkill& used, const AsyncSkill::Now& now) {
        if (used.execution_ == id) {
            used.end({UsedSkillEnd::Kind::refused, {}, Reason::error, now.reason_text});
        }
    });
}

/// Halts an execution whose start was sent and not answered: the server may have begun it.
void RemoteUsedSkill::haltIfRuns(const std::string& id) {
    if (!skill_) {
        return;
    }
    const auto sent = skill_->skill.execution(
        id, [link = link_, id](const opcua::Answer<skill::ExecutionRecord>& record) {
            if (record && (record->state == State::running || record->state == State::suspended)) {
                link->post([id](RemoteUsedSkill& used) { used.haltLeftOver(id); });
            }
        });
    static_cast<void>(sent);  // nothing can be done about a server that cannot be reached
}

/// Halt names no execution: one that was begun meanwhile must not be hit.
void RemoteUsedSkill::haltLeftOver(const std::string& id) {
    if (!execution_.empty()) {
        unsure_ = id;
        return;
    }
    left_over_ = true;
    static_cast<void>(command(Method::halt));
}

void RemoteUsedSkill::withReason(
    std::string otherwise, std::function<void(RemoteUsedSkill&, const AsyncSkill::Now&)> then) {
    connection_.run(
        [skill = skill_, link = link_, otherwise = std::move(otherwise), then = std::move(then)] {
            auto read = skill ? skill->skill.now() : opcua::Answer<AsyncSkill::Now>();
            auto now = read ? std::move(*read) : AsyncSkill::Now();
            if (now.reason_text.empty()) {
                now.reason_text = otherwise;
            }
            link->post([then, now = std::move(now)](RemoteUsedSkill& used) { then(used, now); });
        });
}

void RemoteUsedSkill::onTransition(const skill::TransitionEvent& event) {
    state_ = event.to;
    reason_text_ = event.reason_text;
    if (execution_.empty() || event.execution_id != execution_) {
        return;
    }
    switch (event.number) {
        case TransitionNumber::ready_to_running:
            return;
        case TransitionNumber::running_to_suspended:
            return report(State::suspended);
        case TransitionNumber::suspended_to_running:
            return report(State::running);
        case TransitionNumber::running_to_ready:
            return finished();
        case TransitionNumber::suspended_to_ready:
            return endHalted(event.reason, kResetMeanwhile);
        default:
            return endHalted(event.reason, event.reason_text);
    }
}

void RemoteUsedSkill::onStopping(const skill::StoppingEvent& event) {
    if (listener_ != nullptr && !execution_.empty() && event.execution_id == execution_) {
        listener_->onStopping({event.to, event.reason, event.reason_text});
    }
}

/// Asks what has become of the skill, or of its execution that was begun here.
void RemoteUsedSkill::onMissed() {
    if (!skill_) {
        return;  // once it is back, it is looked at
    }
    if (execution_.empty()) {
        withReason({},
                   [](RemoteUsedSkill& used, const AsyncSkill::Now& now) { used.refresh(now); });
    } else if (!started_) {
        missed_ = true;
    } else {
        const auto sent = skill_->skill.execution(
            execution_, [link = link_, id = execution_](const auto& record) {
                link->post([id, record](RemoteUsedSkill& used) { used.caughtUp(id, record); });
            });
        if (!sent) {
            endLost(sent.error().message);
        }
    }
}

void RemoteUsedSkill::caughtUp(const std::string& id,
                               const opcua::Answer<skill::ExecutionRecord>& record) {
    if (execution_ != id) {
        return;
    }
    if (!record) {
        haltIfRuns(id);
        endLost("what became of it: " + record.error().message);
        return;
    }
    tellMissed(*record);
}

/// Reports the state that missed events would have reported.
void RemoteUsedSkill::tellMissed(const skill::ExecutionRecord& record) {
    state_ = record.state;
    switch (record.state) {
        case State::suspended:
        case State::running:
            return report(record.state);
        case State::ready:
            if (record.reason == Reason::finished) {
                return end({UsedSkillEnd::Kind::finished, record.result});
            }
            return endHalted(record.reason,
                             record.reason == Reason::error ? kResetSinceHalted : kResetMeanwhile);
        case State::halted:
            reason_text_ = record.reason_text;
            return endHalted(record.reason, record.reason_text);
    }
}

/// Fetches the result, if there is any.
void RemoteUsedSkill::finished() {
    if (description_.results.empty() || !skill_) {
        end({});
        return;
    }
    const auto sent = skill_->skill.execution(
        execution_,
        [link = link_, id = execution_](const opcua::Answer<skill::ExecutionRecord>& record) {
            link->post([id, record](RemoteUsedSkill& used) {
                if (used.execution_ != id) {
                    return;
                }
                if (record) {
                    used.end({UsedSkillEnd::Kind::finished, record->result});
                } else {
                    used.endLost("its result: " + record.error().message);
                }
            });
        });
    if (!sent) {
        endLost(sent.error().message);
    }
}

void RemoteUsedSkill::tell(void (UsedSkillListener::*event)()) {
    if (listener_ != nullptr) {
        (listener_->*event)();
    }
}

/// The state alone does not say what was reported: a foreign skill's transitions carry no id.
void RemoteUsedSkill::report(State state) {
    if (std::exchange(reported_, state) != state) {
        tell(state == State::suspended ? &UsedSkillListener::onSuspended
                                       : &UsedSkillListener::onResumed);
    }
}

void RemoteUsedSkill::endHalted(Reason reason, std::string text) {
    end({UsedSkillEnd::Kind::halted, {}, reason, std::move(text)});
}

void RemoteUsedSkill::endLost(std::string text) {
    end({UsedSkillEnd::Kind::lost, {}, Reason::device_lost, std::move(text)});
}

void RemoteUsedSkill::end(UsedSkillEnd end) {
    execution_.clear();
    if (skill_) {
        skill_->skill.unlock();
    }
    if (const auto unsure = std::exchange(unsure_, {}); !unsure.empty()) {
        haltIfRuns(unsure);
    }
    if (auto* listener = std::exchange(listener_, nullptr)) {
        listener->onEnd(std::move(end));
    }
}

void RemoteUsedSkill::release() {
    listener_ = nullptr;
    reset_.reset();
}

Result<void> RemoteUsedSkill::command(Method method) {
    if (!skill_) {
        return fail(Errc::connection_lost, lost_);
    }
    auto sent = skill_->skill.call(
        method, [link = link_, method, id = execution_](const opcua::Answer<>& answer) {
            if (!answer) {
                link->post([method, id, failure = answer.error()](RemoteUsedSkill& used) {
                    used.refused(method, id, failure);
                });
            }
        });
    return sent ? Result<void>{} : fail(sent.error());
}

void RemoteUsedSkill::refused(Method method, const std::string& id, const opcua::Failure& failure) {
    withReason(failure.message, [method, id, code = failure.code](RemoteUsedSkill& used,
                                                                  const AsyncSkill::Now& now) {
        if (used.listener_ != nullptr && !id.empty() && used.execution_ == id) {
            used.listener_->onRefused(method, {code, now.reason_text});
        }
    });
}

Result<void> RemoteUsedSkill::suspend() {
    if (!execution_.empty() && !started_) {
        suspend_wanted_ = true;
        return {};
    }
    return command(Method::suspend);
}

void RemoteUsedSkill::halt() {
    if (!execution_.empty() && !started_) {
        halt_wanted_ = true;
        return;
    }
    const auto sent = command(Method::halt);
    if (!sent && skill_) {  // it has no Halt; if the server is lost, lost() reports it
        link_->post([id = execution_, error = sent.error()](RemoteUsedSkill& used) {
            if (used.listener_ != nullptr && !id.empty() && used.execution_ == id) {
                used.listener_->onRefused(Method::halt, error);
            }
        });
    }
}

/// Each is sent, also while the answer to another is awaited: that may be a refusal.
Result<void> RemoteUsedSkill::reset(UsedSkillListener& listener) {
    listener_ = &listener;
    if (!skill_) {
        return fail(Errc::connection_lost, lost_);
    }
    const auto call = ++reset_count_;
    const auto sent =
        skill_->skill.call(Method::reset, [link = link_, call](const opcua::Answer<>& answer) {
            link->post([call, answer](RemoteUsedSkill& used) { used.wasReset(call, answer); });
        });
    if (!sent) {
        return fail(sent.error());
    }
    reset_ = call;
    return {};
}

void RemoteUsedSkill::wasReset(std::uint64_t call, const opcua::Answer<>& answer) {
    if (reset_ != call) {
        return;
    }
    if (answer) {
        state_ = State::ready;
        tellReset({});
        return;
    }
    withReason(answer.error().message, [call, code = answer.error().code](
                                           RemoteUsedSkill& used, const AsyncSkill::Now& now) {
        if (used.reset_ != call) {
            return;
        }
        const bool ready = now.state == State::ready;  // somebody else was quicker
        used.state_ = ready ? now.state : used.state_;
        used.tellReset(ready ? Result<void>{} : fail(code, now.reason_text));
    });
}

void RemoteUsedSkill::tellReset(const Result<void>& outcome) {
    reset_.reset();
    if (listener_ != nullptr && execution_.empty()) {
        listener_->onReset(outcome);
    }
}

}  // namespace metier::client
