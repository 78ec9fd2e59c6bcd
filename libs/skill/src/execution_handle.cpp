#include "metier/skill/execution_handle.hpp"

#include <utility>

#include "execution_core.hpp"

namespace metier::skill {

namespace {

const std::string kNoId;

}  // namespace

ExecutionHandle::ExecutionHandle(std::shared_ptr<ExecutionCore> core) : core_(std::move(core)) {}

const std::string& ExecutionHandle::id() const noexcept {
    return core_ ? core_->id : kNoId;
}

void ExecutionHandle::finish(ValueMap result) const {
    post(core_, [result = std::move(result)](ExecutionSink& sink) mutable {
        sink.onFinish(std::move(result));
    });
}

void ExecutionHandle::fail(Reason reason, std::string text) const {
    post(core_, [reason, text = std::move(text)](ExecutionSink& sink) mutable {
        sink.onFail(reason, std::move(text));
    });
}

void ExecutionHandle::atRest() const {
    const auto request = core_ ? core_->stop_request.load() : 0;
    post(core_, [request](ExecutionSink& sink) { sink.onAtRest(request); });
}

void ExecutionHandle::progress(Value intermediate) const {
    post(core_, [value = std::move(intermediate)](ExecutionSink& sink) mutable {
        sink.onProgress(std::move(value));
    });
}

void ExecutionHandle::step(std::string name) const {
    post(core_,
         [name = std::move(name)](ExecutionSink& sink) mutable { sink.onStep(std::move(name)); });
}

void ExecutionHandle::suspend(std::string why) const {
    post(core_, [why = std::move(why)](ExecutionSink& sink) mutable {
        sink.onSuspendAsked(std::move(why));
    });
}

void ExecutionHandle::started(StartedExecution child) const {
    post(core_, [child = std::move(child)](ExecutionSink& sink) mutable {
        sink.onStarted(std::move(child));
    });
}

}  // namespace metier::skill
