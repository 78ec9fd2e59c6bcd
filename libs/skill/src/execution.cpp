#include "metier/skill/execution.hpp"

#include <utility>

#include "execution_core.hpp"

namespace metier::skill {

namespace {

const std::string kNoId;

}  // namespace

Execution::Execution(std::shared_ptr<ExecutionCore> core) : core_(std::move(core)) {}

const std::string& Execution::id() const noexcept {
    return core_ ? core_->id : kNoId;
}

void Execution::finish(ValueMap result) const {
    post(core_, [result = std::move(result)](ExecutionSink& sink) mutable {
        sink.onFinish(std::move(result));
    });
}

void Execution::fail(Reason reason, std::string text) const {
    post(core_, [reason, text = std::move(text)](ExecutionSink& sink) mutable {
        sink.onFail(reason, std::move(text));
    });
}

void Execution::atRest() const {
    const auto request = core_ ? core_->stop_request.load() : 0;
    post(core_, [request](ExecutionSink& sink) { sink.onAtRest(request); });
}

void Execution::progress(Value intermediate) const {
    post(core_, [value = std::move(intermediate)](ExecutionSink& sink) mutable {
        sink.onProgress(std::move(value));
    });
}

void Execution::step(std::string name) const {
    post(core_,
         [name = std::move(name)](ExecutionSink& sink) mutable { sink.onStep(std::move(name)); });
}

void Execution::suspend(std::string why) const {
    post(core_, [why = std::move(why)](ExecutionSink& sink) mutable {
        sink.onSuspendAsked(std::move(why));
    });
}

void Execution::started(StartedExecution child) const {
    post(core_, [child = std::move(child)](ExecutionSink& sink) mutable {
        sink.onStarted(std::move(child));
    });
}

}  // namespace metier::skill
