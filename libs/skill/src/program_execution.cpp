#include <fmt/format.h>

#include <memory>
#include <string>
#include <utility>

#include "execution_core.hpp"
#include "metier/skill/program.hpp"
#include "program_turn.hpp"

namespace metier::skill {

namespace {

Reason faultReason(Reason reason) noexcept {
    return haltedBecause(reason) == SubState::halted_by_client ? Reason::error : reason;
}

}  // namespace

Result<void> Program::startNow(const Caller& caller) {
    if (auto access = parameters_.checkAccess(caller.session_id); !access) {
        return access;
    }
    auto& resource = options_.resource;
    if (auto free = resource ? resource->checkFree() : Result<void>{}; !free) {
        return free;
    }
    if (auto complete = parameters_.checkComplete(); !complete) {
        return complete;
    }
    auto body = guarded([this] { return skill_->prepare(parameters_.values()); });
    if (!body) {
        return metier::fail(std::move(body.error()));
    }
    if (!*body) {
        return metier::fail(Errc::internal, "the skill made no body");
    }
    if (resource) {
        resource->acquire(description_.name);
    }
    body_ = std::move(*body);
    execution_ = std::make_shared<ExecutionCore>(executor_,
                                                 fmt::format("{}-{}", boot_id_, ++execution_count_),
                                                 static_cast<ExecutionSink&>(*this));
    owner_session_ = caller.session_id;
    commit(TransitionNumber::ready_to_running, {});
    releaseParameters();
    startBody();
    return {};
}

void Program::startBody() {
    const auto begun = guarded([this] { body_->start(Execution(execution_)); });
    if (!begun) {
        forceHalted({Reason::error, begun.error().message});
    }
}

void Program::onFinish(ValueMap result) {
    inTurn([this, result = std::move(result)]() mutable { finished(std::move(result)); });
}

void Program::finished(ValueMap result) {
    if (state_ == State::suspended) {
        finished_while_suspended_ = std::move(result);
        return;
    }
    if (state_ != State::running) {
        return;
    }
    if (halting_) {
        halted(*halting_);
        return;
    }
    if (const auto taken = takeResult(result); !taken) {
        halted({Reason::error, taken.error().message});
        return;
    }
    notify([this](ProgramObserver& observer) { observer.onResult(final_result_); });
    end(TransitionNumber::running_to_ready, {Reason::finished});
}

/// Makes `result` the final one, or leaves that as it was.
Result<void> Program::takeResult(ValueMap& result) {
    for (const auto& field : description_.results) {
        const auto found = result.find(field.name);
        if (found != result.end() && !isNull(found->second) &&
            typeOf(found->second) != field.type) {
            return metier::fail(Errc::type_mismatch,
                                fmt::format("result {}: {} expected, {} given", field.name,
                                            toString(field.type), toString(typeOf(found->second))));
        }
    }
    for (const auto& field : description_.results) {
        const auto found = result.find(field.name);
        final_result_.find(field.name)->second =
            found == result.end() ? Value{} : std::move(found->second);
    }
    return {};
}

void Program::onFail(Reason reason, std::string text) {
    inTurn([this, cause = Cause{faultReason(reason), std::move(text)}]() mutable {
        if (body_) {
            halted(std::move(cause));
        }
    });
}

/// Lets go of body and device; the execution's handles go nowhere from here on.
void Program::endExecution() {
    rest_timer_.cancel();
    halting_.reset();
    finished_while_suspended_.reset();
    if (execution_) {
        execution_->sink = nullptr;
    }
    if (body_ && options_.resource) {
        options_.resource->release();
    }
    body_.reset();
}

/// Goes where no execution is; device and parameters are free then.
void Program::end(TransitionNumber transition, Cause cause) {
    endExecution();
    commit(transition, std::move(cause));
    releaseParameters();
}

/// Running or Suspended becomes Halted; the device stands still.
void Program::halted(Cause cause) {
    const auto transition = state_ == State::running ? TransitionNumber::running_to_halted
                                                     : TransitionNumber::suspended_to_halted;
    end(transition, std::move(cause));
}

void Program::forceHalted(Cause cause) {
    body_->forceStop();
    halted(std::move(cause));
}

Result<void> Program::suspendNow() {
    if (!description_.suspendable) {
        return metier::fail(Errc::not_supported,
                            fmt::format("{} cannot be suspended", description_.name));
    }
    ++execution_->stop_request;
    if (auto asked = guarded([this] { return body_->suspend(); }); !asked) {
        return asked;
    }
    setSubState(SubState::stopping);
    armRestDeadline();
    return {};
}

Result<void> Program::resumeNow() {
    if (finished_while_suspended_) {
        auto result = std::move(*finished_while_suspended_);
        finished_while_suspended_.reset();
        commit(TransitionNumber::suspended_to_running, {});
        finished(std::move(result));
        return {};
    }
    if (auto resumed = guarded([this] { return body_->resume(); }); !resumed) {
        return resumed;
    }
    commit(TransitionNumber::suspended_to_running, {});
    return {};
}

Result<void> Program::haltNow() {
    if (state_ == State::ready) {
        end(TransitionNumber::ready_to_halted, {});
    } else if (state_ == State::suspended) {
        giveUpSuspended();
        halted({});
    } else if (!halting_) {
        brake({});
    }
    return {};
}

/// Has a running body brake; Halted with `cause` follows at standstill.
void Program::brake(Cause cause) {
    halting_ = std::move(cause);
    if (sub_state_ != SubState::stopping) {
        ++execution_->stop_request;
        setSubState(SubState::stopping);
    }
    armRestDeadline();
    if (const auto asked = guarded([this] { body_->halt(); }); !asked) {
        forceHalted({Reason::error, asked.error().message});
    }
}

void Program::armRestDeadline() {
    rest_timer_ = executor_->after(options_.rest_deadline,
                                   [this] { inTurn([this] { restDeadlinePassed(); }); });
}

void Program::restDeadlinePassed() {
    const auto reason = halting_ ? faultReason(halting_->reason) : Reason::error;
    auto text = fmt::format("not at rest within {} ms, the device's own stop was used",
                            options_.rest_deadline.count());
    if (halting_ && !halting_->text.empty()) {
        text += fmt::format(" ({})", halting_->text);
    }
    forceHalted({reason, std::move(text)});
}

void Program::onAtRest(std::uint32_t stop_request) {
    inTurn([this, stop_request] {
        if (!body_ || sub_state_ != SubState::stopping ||
            stop_request != execution_->stop_request) {
            return;
        }
        rest_timer_.cancel();
        if (halting_) {
            halted(*halting_);
        } else {
            commit(TransitionNumber::running_to_suspended, {});
        }
    });
}

void Program::giveUpSuspended() {
    if (!guarded([this] { body_->halt(); })) {
        body_->forceStop();
    }
}

Result<void> Program::resetNow() {
    if (state_ == State::suspended) {
        giveUpSuspended();
        end(TransitionNumber::suspended_to_ready, {});
        return {};
    }
    if (auto agreed = guarded([this] { return skill_->reset(); }); !agreed) {
        reason_text_ = agreed.error().message;
        notify([this](ProgramObserver& observer) { observer.onReason(reason_, reason_text_); });
        return agreed;
    }
    commit(TransitionNumber::halted_to_ready, {});
    return {};
}

void Program::ownerLost(std::string text) {
    inTurn([this, text = std::move(text)]() mutable {
        if (state_ == State::running && !halting_) {
            brake({Reason::owner_lost, std::move(text)});
        }
    });
}

void Program::deviceLost(std::string text) {
    inTurn([this, cause = Cause{Reason::device_lost, std::move(text)}]() mutable {
        if (body_) {
            forceHalted(std::move(cause));
        } else if (state_ == State::ready) {
            end(TransitionNumber::ready_to_halted, std::move(cause));
        } else {
            reason_ = cause.reason;
            reason_text_ = std::move(cause.text);
            setSubState(SubState::halted_device_lost);
            notify([this](ProgramObserver& observer) { observer.onReason(reason_, reason_text_); });
        }
    });
}

void Program::onProgress(Value intermediate) {
    inTurn([this, value = std::move(intermediate)]() mutable {
        intermediate_ = std::move(value);
        notify([this](ProgramObserver& observer) { observer.onProgress(intermediate_); });
    });
}

void Program::onStep(std::string name) {
    inTurn([this, name = std::move(name)]() mutable {
        step_ = std::move(name);
        if (state_ == State::running) {
            setSubState(sub_state_);
        }
    });
}

}  // namespace metier::skill
