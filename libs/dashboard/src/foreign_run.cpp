#include "foreign_run.hpp"

#include "await_answer.hpp"

namespace metier::dashboard {

using composition::UsedSkillEnd;
using skill::Reason;
using skill::State;
using Kind = UsedSkillEnd::Kind;

void ForeignRun::begin(const std::shared_ptr<client::AsyncSkill>& skill,
                       const skill::StartRequest& request) {
    if (!store_.records) {
        return;
    }
    settle();
    const auto& address = skill->address();
    const std::lock_guard lock(mutex_);
    skill_ = skill;
    id_ = request.execution_id;
    started_ = false;
    halted_by_.clear();
    execution_.emplace(
        store_.records,
        server::ForeignPlace{store_.server_url, address.controllerName(), address.name}, request,
        client::textOf(skill->lacks()));
}

void ForeignRun::answered(const opcua::Answer<std::string>& answer) {
    std::string id;
    {
        const std::lock_guard lock(mutex_);
        started_ = answer.has_value();
        id = id_;
    }
    if (answer) {
        look();  // it may be over
        return;
    }
    const auto& failure = answer.error();
    const bool refused = failure.delivery == opcua::Failure::Delivery::answered;
    end(id, {refused ? Kind::refused : Kind::lost, {}, Reason::error, failure.message});
}

void ForeignRun::note(const skill::TransitionEvent& event) {
    const bool rests = event.from == State::running && event.to == State::suspended;
    const bool goes_on = event.from == State::suspended && event.to == State::running;
    const std::lock_guard lock(mutex_);
    if (execution_ && started_ && (rests || goes_on)) {
        execution_->add(event.from, event.to);
    }
}

ForeignRun::Open ForeignRun::open() {
    const std::lock_guard lock(mutex_);
    return execution_ && started_ ? Open{skill_.lock(), id_} : Open{};
}

void ForeignRun::look() {
    const auto [skill, id] = open();
    if (!skill) {
        return;
    }
    const auto sent = skill->execution(id, [self = shared_from_this(), name = id](
                                               const auto& record) { self->looked(name, record); });
    if (!sent) {
        looked(id, tl::unexpected(sent.error()));
    }
}

void ForeignRun::expectHalt(const std::string& why) {
    const std::lock_guard lock(mutex_);
    halted_by_ = why;
}

void ForeignRun::settle() {
    const auto [skill, id] = open();
    if (!skill) {
        return;
    }
    const auto& asked = *skill;
    const auto& name = id;
    looked(id, awaitAnswer<skill::ExecutionRecord>(
                   [&](auto done) { return asked.execution(name, std::move(done)); }));
    std::string halted_by;
    {
        const std::lock_guard lock(mutex_);
        halted_by = halted_by_;
    }
    end(id, {halted_by.empty() ? Kind::lost : Kind::halted,
             {},
             Reason::by_client,
             halted_by.empty() ? "its end was not published" : halted_by});
}

/// A read that failed says nothing of the execution, unless the connection is lost.
void ForeignRun::looked(const std::string& id,
                        const opcua::Answer<skill::ExecutionRecord>& record) {
    if (!record) {
        if (record.error().code == Errc::connection_lost) {
            end(id, {Kind::lost, {}, Reason::none, record.error().message});
        }
        return;
    }
    std::string halted_by;
    {
        const std::lock_guard lock(mutex_);
        halted_by = halted_by_;
    }
    const bool over = record->state == State::halted || record->state == State::ready;
    const bool failed = record->reason == Reason::error;  // halted, and perhaps reset since
    if (over && failed && !halted_by.empty()) {
        end(id, {Kind::halted, {}, Reason::by_client, halted_by});
    } else if (record->state == State::halted) {
        end(id, {Kind::halted, {}, record->reason, record->reason_text});
    } else if (over && record->reason == Reason::finished) {
        end(id, {Kind::finished, record->result});
    } else if (over) {
        end(id, {Kind::halted,
                 {},
                 record->reason,
                 failed ? "it was halted, then reset" : "it was suspended, then reset"});
    }
}

/// An answer may be late: `id` is that of the execution that it is about.
void ForeignRun::end(const std::string& id, const UsedSkillEnd& end) {
    const std::lock_guard lock(mutex_);
    if (execution_ && id == id_) {
        execution_->end(end);
        execution_.reset();
    }
}

}  // namespace metier::dashboard
