#include "metier/skill/execution_handle.hpp"

#include <utility>

#include "program_call.hpp"

namespace metier::skill {

namespace {

const std::string kNoId;

}  // namespace

ExecutionHandle::ExecutionHandle(std::shared_ptr<ExecutionCore> core) : core_(std::move(core)) {}

const std::string& ExecutionHandle::id() const noexcept {
    return core_ ? core_->id : kNoId;
}

void ExecutionHandle::finish(ValueMap result) const {
    Program::post(core_, [result = std::move(result)](Program& program) mutable {
        program.finish(std::move(result));
    });
}

void ExecutionHandle::fail(Reason reason, std::string text) const {
    Program::post(core_, [reason, text = std::move(text)](Program& program) mutable {
        program.fail(reason, std::move(text));
    });
}

void ExecutionHandle::atRest() const {
    const auto request = core_ ? core_->stop_request.load() : 0;
    Program::post(core_, [request](Program& program) { program.takeRest(request); });
}

void ExecutionHandle::progress(Value intermediate) const {
    Program::post(core_, [value = std::move(intermediate)](Program& program) mutable {
        program.takeProgress(std::move(value));
    });
}

void ExecutionHandle::step(std::string name) const {
    Program::post(core_, [name = std::move(name)](Program& program) mutable {
        program.takeStep(std::move(name));
    });
}

void ExecutionHandle::suspend(std::string why) const {
    Program::post(core_, [why = std::move(why)](Program& program) { program.suspendAsked(why); });
}

void ExecutionHandle::started(StartedExecution child) const {
    Program::post(core_, [child = std::move(child)](Program& program) {
        program.notify([&](ProgramObserver& observer) { observer.onStarted(child); });
    });
}

}  // namespace metier::skill
