#include "metier/composition/local_used_skill.hpp"

#include <utility>

namespace metier::composition {

using skill::State;
using skill::TransitionNumber;

LocalUsedSkill::LocalUsedSkill(skill::Program& program, std::shared_ptr<skill::Executor> executor,
                               skill::Caller caller)
    : program_(program), executor_(std::move(executor)), caller_(std::move(caller)) {
    program_.attach(*this);
}

LocalUsedSkill::~LocalUsedSkill() {
    *alive_ = false;
    release();
    program_.detach(*this);
}

template <typename Tell>
void LocalUsedSkill::post(Tell tell) {
    executor_->post([link = link_, tell = std::move(tell)]() mutable {
        if (link->listener != nullptr) {
            tell(*link->listener);
        }
    });
}

Result<void> LocalUsedSkill::reset(UsedSkillListener& listener) {
    release();
    link_ = std::make_shared<Link>(Link{&listener});
    auto outcome = program_.reset(caller_);
    if (outcome) {
        post([](UsedSkillListener& to) { to.onReset({}); });
    }
    return outcome;
}

template <typename Answer>
void LocalUsedSkill::answer(std::function<void(Result<Answer>)> done, Result<Answer> answer) {
    executor_->post([alive = alive_, done = std::move(done), answer = std::move(answer)]() mutable {
        if (*alive) {
            done(std::move(answer));
        }
    });
}

void LocalUsedSkill::check(const skill::CheckRequest& request, skill::CheckDone done) {
    program_.check(
        caller_, request,
        [this, alive = alive_, done = std::move(done)](Result<skill::CheckReport> report) {
            if (*alive) {
                answer(done, std::move(report));
            }
        });
}

void LocalUsedSkill::compareClocks(std::function<void(Result<ClockOffset>)> done) {
    answer(std::move(done), Result<ClockOffset>());
}

void LocalUsedSkill::begin(skill::StartRequest request, UsedSkillListener& listener) {
    release();
    link_ = std::make_shared<Link>(Link{&listener});
    execution_ = request.execution_id;
    auto begun = program_.startWith(caller_, std::move(request));
    if (!begun) {
        end({UsedSkillEnd::Kind::refused, {}, skill::Reason::error, begun.error().message});
        return;
    }
    execution_ = std::move(*begun);
}

void LocalUsedSkill::end(UsedSkillEnd end) {
    execution_.clear();
    post([end = std::move(end)](UsedSkillListener& to) mutable { to.onEnd(std::move(end)); });
}

void LocalUsedSkill::halt() {
    if (const auto halted = program_.halt(caller_); !halted) {
        post([error = halted.error()](UsedSkillListener& to) {
            to.onRefused(skill::Method::halt, error);
        });
    }
}

UsedSkillEnd LocalUsedSkill::endOf(const skill::TransitionEvent& event) const {
    if (event.number == TransitionNumber::running_to_ready) {
        return {UsedSkillEnd::Kind::finished, program_.finalResult(), event.reason, {}};
    }
    if (event.to == State::ready) {
        return {
            UsedSkillEnd::Kind::halted, {}, event.reason, "it was reset while it was suspended"};
    }
    return {UsedSkillEnd::Kind::halted, {}, event.reason, event.reason_text};
}

void LocalUsedSkill::onTransition(const skill::TransitionEvent& event) {
    if (execution_.empty() || event.execution_id != execution_) {
        return;
    }
    switch (event.number) {
        case TransitionNumber::ready_to_running:
            return;
        case TransitionNumber::running_to_suspended:
            return post([](UsedSkillListener& to) { to.onSuspended(); });
        case TransitionNumber::suspended_to_running:
            return post([](UsedSkillListener& to) { to.onResumed(); });
        default:
            return end(endOf(event));
    }
}

void LocalUsedSkill::onStopping(const skill::StoppingEvent& event) {
    if (!execution_.empty() && event.execution_id == execution_) {
        post([stop = UsedSkillStop{event.to, event.reason, event.reason_text}](
                 UsedSkillListener& to) { to.onStopping(stop); });
    }
}

void LocalUsedSkill::onProgress(const skill::Value& intermediate) {
    if (!execution_.empty()) {
        post([intermediate](UsedSkillListener& to) { to.onProgress(intermediate); });
    }
}

}  // namespace metier::composition
