#include "remote_skill/remote_child.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <utility>

#include "remote_skill/clock_offset.hpp"

namespace metier::client {

using composition::ChildListener;
using skill::Method;
using skill::Reason;
using skill::State;
using skill::TransitionNumber;
using client::AsyncSkill;

RemoteChild::RemoteChild(Connection& connection, std::shared_ptr<ChildLink> link, std::string name,
                         std::string origin)
    : connection_(connection),
      link_(std::move(link)),
      name_(std::move(name)),
      origin_(std::move(origin)) {
    link_->attach(this);
}

RemoteChild::~RemoteChild() {
    link_->attach(nullptr);
    drop();
}

/// To end a subscription, or a client, takes time: that is for the connection's thread.
void RemoteChild::drop() {
    if (skill_) {
        connection_.run([skill = std::move(skill_)]() mutable { skill.reset(); });
    }
}

Result<void> RemoteChild::available() const {
    return skill_ ? Result<void>{} : fail(Errc::connection_lost, lost_);
}

bool RemoteChild::isOurs(const std::string& execution) const {
    return execution.starts_with(origin_ + "/") || execution.starts_with(origin_ + "~");
}

void RemoteChild::adopt(std::shared_ptr<OpenSkill> skill, const AsyncSkill::Now& now) {
    drop();
    skill_ = std::move(skill);
    description_ = skill_->skill.description();
    state_ = now.state;
    reason_text_ = now.reason_text;
    const bool runs = state_ == State::running || state_ == State::suspended;
    if (runs && isOurs(now.execution_id)) {
        spdlog::warn("{}: execution {} is {} and nobody waits for it: it is halted", name_,
                     now.execution_id, toString(state_));
        left_over_ = true;
        static_cast<void>(command(Method::halt));
    }
}

/// What was read while nothing runs from here; all else is told by events.
void RemoteChild::refresh(const AsyncSkill::Now& now) {
    if (skill_ && execution_.empty() && !reset_ && !left_over_) {
        state_ = now.state;
        reason_text_ = now.reason_text;
    }
}

void RemoteChild::lost(const std::string& why) {
    drop();
    lost_ = why;
    if (reset_) {
        tellReset(fail(Errc::connection_lost, why));
    }
    if (!execution_.empty()) {
        end({ChildEnd::Kind::lost, {}, Reason::device_lost, why});
    }
}

void RemoteChild::check(const skill::ValueMap& parameters,
                        std::function<void(Result<skill::CheckReport>)> done) {
    using Report = Result<skill::CheckReport>;
    const auto told = [link = link_, done = std::move(done)](Report report) {
        link->post([done, report = std::move(report)](RemoteChild& /*child*/) { done(report); });
    };
    const auto sent =
        skill_ ? skill_->skill.check(parameters,
                                     [told](const opcua::Answer<skill::CheckReport>& report) {
                                         told(report ? Report(*report) : fail(report.error()));
                                     })
               : opcua::failed(opcua::status::kBadConnectionClosed, lost_);
    if (!sent) {
        told(fail(sent.error()));
    }
}

void RemoteChild::compareClocks(std::function<void(Result<composition::ClockOffset>)> done) {
    connection_.run([skill = skill_, link = link_, lost = lost_, done = std::move(done)] {
        auto offset = skill ? clockOffsetOf(*skill->client)
                            : Result<composition::ClockOffset>(fail(Errc::connection_lost, lost));
        link->post([done, offset = std::move(offset)](RemoteChild& /*child*/) { done(offset); });
    });
}

void RemoteChild::begin(skill::StartRequest request, ChildListener& listener) {
    listener_ = &listener;
    execution_ = request.execution_id;
    request.parent.server = connection_.options().own_server;
    started_ = halt_wanted_ = suspend_wanted_ = left_over_ = missed_ = false;
    const auto sent =
        skill_
            ? skill_->skill.startWith(
                  request,
                  [link = link_, id = execution_](const opcua::Answer<std::string>& answer) {
                      link->post([id, answer](RemoteChild& child) { child.started(id, answer); });
                  })
            : opcua::failed(opcua::status::kBadConnectionClosed, lost_);
    if (!sent) {
        link_->post([id = execution_, text = sent.error().message](RemoteChild& child) {
            if (child.execution_ == id) {
                child.end({ChildEnd::Kind::lost, {}, Reason::device_lost, text});
            }
        });
    }
}

void RemoteChild::started(const std::string& id, const opcua::Answer<std::string>& answer) {
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
        end({ChildEnd::Kind::lost, {}, Reason::device_lost, failure.message});
        return;
    }
    withReason(failure.message, [id](RemoteChild& child, const AsyncSkill::Now& now) {
        if (child.execution_ == id) {
            child.end({ChildEnd::Kind::refused, {}, Reason::error, now.reason_text});
        }
    });
}

/// What was sent may have been carried out, though nobody has heard of it.
void RemoteChild::haltIfRuns(const std::string& id) {
    if (!skill_) {
        return;
    }
    const auto sent = skill_->skill.execution(
        id, [link = link_, id](const opcua::Answer<skill::ExecutionRecord>& record) {
            if (record && (record->state == State::running || record->state == State::suspended)) {
                link->post([id](RemoteChild& child) { child.haltLeftOver(id); });
            }
        });
    static_cast<void>(sent);  // nothing can be done about a server that does not hear
}

/// Halt names no execution: one that was begun meanwhile must not be hit.
void RemoteChild::haltLeftOver(const std::string& id) {
    if (!execution_.empty()) {
        unsure_ = id;
        return;
    }
    left_over_ = true;
    static_cast<void>(command(Method::halt));
}

void RemoteChild::withReason(std::string otherwise,
                             std::function<void(RemoteChild&, const AsyncSkill::Now&)> then) {
    connection_.run(
        [skill = skill_, link = link_, otherwise = std::move(otherwise), then = std::move(then)] {
            auto read = skill ? skill->skill.now() : opcua::Answer<AsyncSkill::Now>();
            auto now = read ? std::move(*read) : AsyncSkill::Now();
            if (now.reason_text.empty()) {
                now.reason_text = otherwise;
            }
            link->post([then, now = std::move(now)](RemoteChild& child) { then(child, now); });
        });
}

void RemoteChild::onTransition(const skill::TransitionEvent& event) {
    state_ = event.to;
    reason_text_ = event.reason_text;
    if (execution_.empty() || event.execution_id != execution_) {
        return;
    }
    switch (event.number) {
        case TransitionNumber::ready_to_running:
            return;
        case TransitionNumber::running_to_suspended:
            if (listener_ != nullptr) {
                listener_->onSuspended();
            }
            return;
        case TransitionNumber::suspended_to_running:
            if (listener_ != nullptr) {
                listener_->onResumed();
            }
            return;
        case TransitionNumber::running_to_ready:
            return finished();
        case TransitionNumber::suspended_to_ready:
            return end(
                {ChildEnd::Kind::halted, {}, event.reason, "it was reset while it was suspended"});
        default:
            return end({ChildEnd::Kind::halted, {}, event.reason, event.reason_text});
    }
}

void RemoteChild::onStopping(const skill::StoppingEvent& event) {
    if (listener_ != nullptr && !execution_.empty() && event.execution_id == execution_) {
        listener_->onStopping({event.to, event.reason, event.reason_text});
    }
}

/// Asks what has become of the skill, or of its execution that was begun here.
void RemoteChild::onMissed() {
    if (!skill_) {
        return;  // once it is back, it is looked at
    }
    if (execution_.empty()) {
        withReason({}, [](RemoteChild& child, const AsyncSkill::Now& now) { child.refresh(now); });
    } else if (!started_) {
        missed_ = true;
    } else {
        const auto sent = skill_->skill.execution(
            execution_, [link = link_, id = execution_](const auto& record) {
                link->post([id, record](RemoteChild& child) { child.caughtUp(id, record); });
            });
        if (!sent) {
            end({ChildEnd::Kind::lost, {}, Reason::device_lost, sent.error().message});
        }
    }
}

void RemoteChild::caughtUp(const std::string& id,
                           const opcua::Answer<skill::ExecutionRecord>& record) {
    if (execution_ != id) {
        return;
    }
    if (!record) {
        haltIfRuns(id);
        end({ChildEnd::Kind::lost,
             {},
             Reason::device_lost,
             "what became of it: " + record.error().message});
        return;
    }
    tellMissed(*record);
}

/// Reports the state that missed events would have reported.
void RemoteChild::tellMissed(const skill::ExecutionRecord& record) {
    const auto before = std::exchange(state_, record.state);
    switch (record.state) {
        case State::suspended:
            if (before != State::suspended && listener_ != nullptr) {
                listener_->onSuspended();
            }
            return;
        case State::running:
            if (before == State::suspended && listener_ != nullptr) {
                listener_->onResumed();
            }
            return;
        case State::ready:
            if (record.reason == Reason::finished) {
                return end({ChildEnd::Kind::finished, record.result});
            }
            return end(
                {ChildEnd::Kind::halted, {}, record.reason, "it was reset while it was suspended"});
        case State::halted:
            reason_text_ = record.reason_text;
            return end({ChildEnd::Kind::halted, {}, record.reason, record.reason_text});
    }
}

/// Fetches the result, if there is any.
void RemoteChild::finished() {
    if (description_.results.empty() || !skill_) {
        end({});
        return;
    }
    const auto sent = skill_->skill.execution(
        execution_,
        [link = link_, id = execution_](const opcua::Answer<skill::ExecutionRecord>& record) {
            link->post([id, record](RemoteChild& child) {
                if (child.execution_ != id) {
                    return;
                }
                child.end(record ? ChildEnd{ChildEnd::Kind::finished, record->result}
                                 : ChildEnd{ChildEnd::Kind::lost,
                                            {},
                                            Reason::device_lost,
                                            "its result: " + record.error().message});
            });
        });
    if (!sent) {
        end({ChildEnd::Kind::lost, {}, Reason::device_lost, sent.error().message});
    }
}

void RemoteChild::end(ChildEnd end) {
    execution_.clear();
    if (const auto unsure = std::exchange(unsure_, {}); !unsure.empty()) {
        haltIfRuns(unsure);
    }
    if (auto* listener = std::exchange(listener_, nullptr)) {
        listener->onEnd(std::move(end));
    }
}

void RemoteChild::release() {
    listener_ = nullptr;
    reset_.reset();
}

Result<void> RemoteChild::command(Method method) {
    if (!skill_) {
        return fail(Errc::connection_lost, lost_);
    }
    auto sent = skill_->skill.call(
        method, [link = link_, method, id = execution_](const opcua::Answer<>& answer) {
            if (!answer) {
                link->post([method, id, failure = answer.error()](RemoteChild& child) {
                    child.refused(method, id, failure);
                });
            }
        });
    return sent ? Result<void>{} : fail(sent.error());
}

void RemoteChild::refused(Method method, const std::string& id, const opcua::Failure& failure) {
    withReason(failure.message,
               [method, id, code = failure.code](RemoteChild& child, const AsyncSkill::Now& now) {
                   if (child.listener_ != nullptr && !id.empty() && child.execution_ == id) {
                       child.listener_->onRefused(method, {code, now.reason_text});
                   }
               });
}

Result<void> RemoteChild::suspend() {
    if (!execution_.empty() && !started_) {
        suspend_wanted_ = true;
        return {};
    }
    return command(Method::suspend);
}

Result<void> RemoteChild::resume() {
    return command(Method::resume);
}

void RemoteChild::halt() {
    if (!execution_.empty() && !started_) {
        halt_wanted_ = true;
        return;
    }
    static_cast<void>(command(Method::halt));  // a server that is lost is told by lost()
}

/// Each is sent, also while the answer to another is awaited: that may be a refusal.
Result<void> RemoteChild::reset(ChildListener& listener) {
    listener_ = &listener;
    if (!skill_) {
        return fail(Errc::connection_lost, lost_);
    }
    const auto call = ++reset_count_;
    const auto sent =
        skill_->skill.call(Method::reset, [link = link_, call](const opcua::Answer<>& answer) {
            link->post([call, answer](RemoteChild& child) { child.wasReset(call, answer); });
        });
    if (!sent) {
        return fail(sent.error());
    }
    reset_ = call;
    return {};
}

void RemoteChild::wasReset(std::uint64_t call, const opcua::Answer<>& answer) {
    if (reset_ != call) {
        return;
    }
    if (answer) {
        state_ = State::ready;
        tellReset({});
        return;
    }
    withReason(answer.error().message,
               [call, code = answer.error().code](RemoteChild& child, const AsyncSkill::Now& now) {
                   if (child.reset_ != call) {
                       return;
                   }
                   const bool ready = now.state == State::ready;  // somebody else was quicker
                   child.state_ = ready ? now.state : child.state_;
                   child.tellReset(ready ? Result<void>{} : fail(code, now.reason_text));
               });
}

void RemoteChild::tellReset(const Result<void>& outcome) {
    reset_.reset();
    if (listener_ != nullptr && execution_.empty()) {
        listener_->onReset(outcome);
    }
}

}  // namespace metier::client
