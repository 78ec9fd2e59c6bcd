#include "metier/composition/local_child.hpp"

#include <utility>

namespace metier::composition {

using skill::State;
using skill::TransitionNumber;

LocalChild::LocalChild(skill::Program& program, std::shared_ptr<skill::Executor> executor,
                       skill::Caller caller)
    : program_(program), executor_(std::move(executor)), caller_(std::move(caller)) {
    program_.attach(*this);
}

LocalChild::~LocalChild() {
    *alive_ = false;
    release();
    program_.detach(*this);
}

template <typename Tell>
void LocalChild::post(Tell tell) {
    executor_->post([link = link_, tell = std::move(tell)]() mutable {
        if (link->listener != nullptr) {
            tell(*link->listener);
        }
    });
}

Result<void> LocalChild::reset(ChildListener& listener) {
    release();
    link_ = std::make_shared<Link>(Link{&listener});
    auto outcome = program_.reset(caller_);
    if (outcome) {
        post([](ChildListener& to) { to.onReset({}); });
    }
    return outcome;
}

template <typename Answer>
void LocalChild::answer(std::function<void(Result<Answer>)> done, Answer answer) {
    executor_->post([alive = alive_, done = std::move(done), answer = std::move(answer)]() mutable {
        if (*alive) {
            done(std::move(answer));
        }
    });
}

void LocalChild::check(const skill::ValueMap& parameters,
                       std::function<void(Result<skill::CheckReport>)> done) {
    answer(std::move(done), program_.check(caller_, parameters));
}

void LocalChild::compareClocks(std::function<void(Result<ClockOffset>)> done) {
    answer(std::move(done), ClockOffset{});
}

void LocalChild::begin(skill::StartRequest request, ChildListener& listener) {
    release();
    link_ = std::make_shared<Link>(Link{&listener});
    execution_ = request.execution_id;
    auto begun = program_.startWith(caller_, std::move(request));
    if (!begun) {
        end({ChildEnd::Kind::refused, {}, skill::Reason::error, begun.error().message});
        return;
    }
    execution_ = std::move(*begun);
}

void LocalChild::end(ChildEnd end) {
    execution_.clear();
    post([end = std::move(end)](ChildListener& to) mutable { to.onEnd(std::move(end)); });
}

Result<void> LocalChild::suspend() {
    return program_.suspend(caller_);
}

Result<void> LocalChild::resume() {
    return program_.resume(caller_);
}

void LocalChild::halt() {
    if (const auto halted = program_.halt(caller_); !halted) {
        post([error = halted.error()](ChildListener& to) {
            to.onRefused(skill::Method::halt, error);
        });
    }
}

ChildEnd LocalChild::endOf(const skill::TransitionEvent& event) const {
    if (event.number == TransitionNumber::running_to_ready) {
        return {ChildEnd::Kind::finished, program_.finalResult(), event.reason, {}};
    }
    if (event.to == State::ready) {
        return {ChildEnd::Kind::halted, {}, event.reason, "it was reset while it was suspended"};
    }
    return {ChildEnd::Kind::halted, {}, event.reason, event.reason_text};
}

void LocalChild::onTransition(const skill::TransitionEvent& event) {
    if (execution_.empty() || event.execution_id != execution_) {
        return;
    }
    switch (event.number) {
        case TransitionNumber::ready_to_running:
            return;
        case TransitionNumber::running_to_suspended:
            return post([](ChildListener& to) { to.onSuspended(); });
        case TransitionNumber::suspended_to_running:
            return post([](ChildListener& to) { to.onResumed(); });
        default:
            return end(endOf(event));
    }
}

void LocalChild::onStopping(const skill::StoppingEvent& event) {
    if (!execution_.empty() && event.execution_id == execution_) {
        post([stop = ChildStop{event.to, event.reason, event.reason_text}](ChildListener& to) {
            to.onStopping(stop);
        });
    }
}

void LocalChild::onProgress(const skill::Value& intermediate) {
    if (!execution_.empty()) {
        post([intermediate](ChildListener& to) { to.onProgress(intermediate); });
    }
}

}  // namespace metier::composition
