#include <fmt/format.h>

#include <memory>
#include <string>
#include <utility>

#include "metier/skill/program.hpp"
#include "program_call.hpp"

namespace metier::skill {

namespace {

constexpr std::size_t kLongestId = 128;

Reason faultReason(Reason reason) noexcept {
    return haltedBecause(reason) == SubState::halted_by_client ? Reason::error : reason;
}

/// Answer of Check where Start would be refused with that error.
CheckReport refusal(const Error& error) {
    return {.possible = false,
            .reason = error.message,
            .code = std::string(toString(error.code)),
            .first_failing_fraction = 0.0};
}

/// Passes on the first answer alone: a skill that throws after its answer has given it.
CheckDone once(CheckDone done) {
    return [open = std::make_shared<CheckDone>(std::move(done))](Result<CheckReport> answer) {
        if (const auto first = std::exchange(*open, nullptr)) {
            first(std::move(answer));
        }
    };
}

}  // namespace

/// Whether parameters and device are free for the caller.
Result<void> Program::checkFree(const Caller& caller) const {
    METIER_TRY(parameters_.checkAccess(caller.session_id));
    return options_.resource ? options_.resource->checkFree() : Result<void>{};
}

Result<void> Program::startWithNow(const Caller& caller, StartRequest& request) {
    diagnostic_.last_method_inputs = request.parameters;
    if (request.execution_id.size() > kLongestId) {
        return metier::fail(Errc::out_of_range,
                            fmt::format("ExecutionId: {} characters, at most {}",
                                        request.execution_id.size(), kLongestId));
    }
    if (options_.names->knows(description_.name, request.execution_id)) {
        return metier::fail(Errc::already_exists, forgottenText(request.execution_id));
    }
    if (request.deadline && clock_.utcNow() > *request.deadline) {
        const auto late = clock_.utcNow() - *request.deadline;
        return metier::fail(
            Errc::timeout,
            fmt::format("the deadline of the start passed {} ms ago",
                        std::chrono::duration_cast<std::chrono::milliseconds>(late).count()));
    }
    METIER_TRY(checkEpoch(caller, request.epoch));
    METIER_TRY(checkFree(caller));
    METIER_ASSIGN(auto snapshot, parameters_.snapshotOf(request.parameters));
    METIER_TRY(begin(caller, std::make_shared<const ValueMap>(std::move(snapshot)),
                     {.id = request.execution_id,
                      .on_owner_loss = request.on_owner_loss,
                      .parent = std::move(request.parent)}));
    request.execution_id = history_.last().id;
    return {};
}

Result<void> Program::checkEpoch(const Caller& caller, std::uint64_t epoch) const {
    if (options_.control) {
        return options_.control->checkEpoch(caller, epoch);
    }
    return epoch == 0 ? Result<void>{}
                      : metier::fail(Errc::locked, fmt::format("nobody gave out epoch {}", epoch));
}

/// Running, with the work that the skill prepares for `snapshot`.
Result<void> Program::begin(const Caller& caller, std::shared_ptr<const ValueMap> snapshot,
                            Order order) {
    METIER_ASSIGN(auto work, guarded([&] { return skill_->prepare(*snapshot); }));
    if (!work) {
        return metier::fail(Errc::internal, "the skill made no work");
    }
    const bool named = !order.id.empty();
    auto core = std::make_shared<ExecutionCore>(
        executor_, named ? std::move(order.id) : fmt::format("{}-{}", boot_id_, ++execution_count_),
        *this);
    if (named) {
        METIER_TRY(noteName(core));
    }
    if (options_.resource) {
        options_.resource->acquire(description_.name);
    }
    work_ = std::move(work);
    execution_ = std::move(core);
    execution_id_ = execution_->id;
    owner_session_ = caller.session_id;
    on_owner_loss_ = order.on_owner_loss;
    history_.add({.id = execution_id_,
                  .client = caller,
                  .parent = std::move(order.parent),
                  .parameters = std::move(snapshot),
                  .start_time = clock_.utcNow()});
    commit(TransitionNumber::ready_to_running, {});
    releaseParameters();
    if (name_kept_) {
        startWork();
    } else {
        name_timer_ = executor_->after(options_.name_deadline,
                                       [this] { inCall([this] { nameDeadlinePassed(); }); });
    }
    return {};
}

/// Has the name written. The work starts once it is on disk: so an execution that is unknown after
/// the death of the process has moved nothing.
Result<void> Program::noteName(const std::shared_ptr<ExecutionCore>& core) {
    METIER_ASSIGN(
        const auto noted,
        options_.names->note(description_.name, core->id, [core](const Result<void>& kept) {
            post(core, [kept](Program& program) { program.nameKept(kept); });
        }));
    name_kept_ = noted == ExecutionNames::Keeping::kept;
    return {};
}

void Program::nameKept(const Result<void>& kept) {
    if (!work_ || name_kept_) {
        return;
    }
    name_timer_.cancel();
    if (!kept) {
        options_.names->forget(description_.name, execution_->id);
        halted({Reason::error, kept.error().message + "; nothing has moved"});
        return;
    }
    name_kept_ = true;
    if (state_ == State::running) {
        startWork();
    }
}

void Program::nameDeadlinePassed() {
    if (work_ && !name_kept_) {
        halted({Reason::error, fmt::format("the name of the execution is not on disk after {} ms; "
                                           "nothing has moved",
                                           options_.name_deadline.count())});
    }
}

CheckReport Program::check(const Caller& caller, const ValueMap& parameters) {
    auto checked = checkNow(caller, parameters);
    auto report = checked ? std::move(*checked) : refusal(checked.error());
    noteCheck(caller, parameters, report);
    return report;
}

void Program::check(const Caller& caller, const CheckRequest& request, CheckDone done) {
    const auto answer = once([this, caller, parameters = request.parameters,
                              done = std::move(done)](Result<CheckReport> checked) {
        if (!checked && checked.error().code == Errc::timeout) {
            done(std::move(checked));
            return;
        }
        auto report = checked ? std::move(*checked) : refusal(checked.error());
        noteCheck(caller, parameters, report);
        done(std::move(report));
    });
    const auto asked =
        checkable(caller, request.parameters).and_then([&](const ValueMap& snapshot) {
            return guarded([&] { skill_->checkFrom(request.starts, snapshot, answer); });
        });
    if (!asked) {
        answer(metier::fail(asked.error()));
    }
}

void Program::noteCheck(const Caller& caller, const ValueMap& parameters,
                        const CheckReport& report) {
    if (!busy_) {
        const Call call(*this);
        notify([&](ProgramObserver& observer) { observer.onCheck(caller, parameters, report); });
    }
}

Result<ValueMap> Program::checkable(const Caller& caller, const ValueMap& parameters) const {
    if (busy_) {
        return metier::fail(Errc::invalid_state, "Check from inside a notification");
    }
    METIER_TRY(checkAllowed(Method::start_with, caller));
    METIER_TRY(checkFree(caller));
    return parameters_.snapshotOf(parameters);
}

Result<CheckReport> Program::checkNow(const Caller& caller, const ValueMap& parameters) {
    METIER_ASSIGN(const auto snapshot, checkable(caller, parameters));
    return guarded([&] { return skill_->check(snapshot); });
}

void Program::startWork() {
    work_started_ = true;
    const auto begun = guarded([this] { work_->start(ExecutionHandle(execution_)); });
    if (!begun) {
        forceHalted({Reason::error, begun.error().message});
    }
}

void Program::finish(ValueMap result) {
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

void Program::fail(Reason reason, std::string text) {
    halted({faultReason(reason), std::move(text) + whyStopping()});
}

/// The cause of a Halt or Suspend that is under way; that of the Halt if it is both.
const Program::Cause* Program::stopCause() const {
    return halting_ ? &*halting_ : suspending_ ? &*suspending_ : nullptr;
}

/// The text of that cause in brackets, to be put behind another text; empty if there is none.
std::string Program::whyStopping() const {
    const auto* cause = stopCause();
    return cause != nullptr && !cause->text.empty() ? fmt::format(" ({})", cause->text)
                                                    : std::string();
}

/// Lets go of work and device; the execution's handles go nowhere from here on.
void Program::endExecution() {
    rest_timer_.cancel();
    name_timer_.cancel();
    name_kept_ = true;
    work_started_ = false;
    halting_.reset();
    suspending_.reset();
    finished_while_suspended_.reset();
    if (execution_) {
        execution_->program = nullptr;
    }
    if (work_ && options_.resource) {
        options_.resource->release();
    }
    work_.reset();
}

/// Goes where no execution is; device and parameters are free then. Ready becomes Halted if the
/// device needs a Reset since the execution was under way.
void Program::end(TransitionNumber transition, Cause cause) {
    endExecution();
    commit(transition, std::move(cause));
    releaseParameters();
    auto not_ready = std::exchange(not_ready_, std::nullopt);
    if (not_ready && state_ == State::ready) {
        end(TransitionNumber::ready_to_halted, std::move(*not_ready));
    }
}

/// Running or Suspended becomes Halted; the device stands still.
void Program::halted(Cause cause) {
    const auto transition = state_ == State::running ? TransitionNumber::running_to_halted
                                                     : TransitionNumber::suspended_to_halted;
    end(transition, std::move(cause));
}

void Program::forceHalted(Cause cause) {
    if (work_started_) {
        work_->forceStop();
    }
    halted(std::move(cause));
}

Result<void> Program::suspendNow(Cause cause) {
    if (!description_.suspendable) {
        return metier::fail(Errc::not_supported,
                            fmt::format("{} cannot be suspended", description_.name));
    }
    if (!work_started_) {
        commit(TransitionNumber::running_to_suspended, std::move(cause));
        return {};
    }
    ++execution_->stop_request;
    if (auto asked = guarded([this] { return work_->suspend(); }); !asked) {
        return asked;
    }
    suspending_ = std::move(cause);
    setSubState(SubState::stopping);
    announceRest(State::suspended, *suspending_);
    armRestDeadline();
    return {};
}

/// Lets observers know before standstill, so that what belongs together stops together.
void Program::announceRest(State to, const Cause& cause) {
    StoppingEvent event{clock_.utcNow(), execution_->id, to, cause.reason, cause.text};
    if (event.reason == Reason::by_client && event.reason_text.empty()) {
        event.reason_text = fmt::format("by {}", diagnostic_.last_method_client_name);
    }
    notify([&](ProgramObserver& observer) { observer.onStopping(event); });
}

void Program::suspendAsked(const std::string& why) {
    if (sub_state_ != SubState::executing) {
        return;
    }
    if (const auto asked = suspendNow({Reason::by_client, why}); !asked) {
        brake({Reason::error, fmt::format("{}; {}", why, asked.error().message)});
    }
}

Result<void> Program::resumeNow(const Caller& caller) {
    if (finished_while_suspended_) {
        auto result = std::move(*finished_while_suspended_);
        finished_while_suspended_.reset();
        commit(TransitionNumber::suspended_to_running, {});
        finish(std::move(result));
        return {};
    }
    if (work_started_) {
        if (auto resumed = guarded([this] { return work_->resume(); }); !resumed) {
            return resumed;
        }
    }
    if (owner_session_.empty()) {
        owner_session_ = caller.session_id;
    }
    commit(TransitionNumber::suspended_to_running, {});
    if (!work_started_ && name_kept_) {
        startWork();
    }
    return {};
}

/// Has a running work brake; Halted with `cause` follows at standstill.
void Program::brake(Cause cause) {
    if (!work_started_) {
        halted(std::move(cause));
        return;
    }
    halting_ = std::move(cause);
    if (sub_state_ != SubState::stopping) {
        ++execution_->stop_request;
        setSubState(SubState::stopping);
    }
    announceRest(State::halted, *halting_);
    armRestDeadline();
    if (const auto asked = guarded([this] { work_->halt(); }); !asked) {
        forceHalted({Reason::error, asked.error().message});
    }
}

void Program::armRestDeadline() {
    rest_timer_ = executor_->after(options_.rest_deadline,
                                   [this] { inCall([this] { restDeadlinePassed(); }); });
}

void Program::restDeadlinePassed() {
    const auto* cause = stopCause();
    const auto reason = cause != nullptr ? faultReason(cause->reason) : Reason::error;
    auto text = fmt::format("not at rest within {} ms, the device's own stop was used",
                            options_.rest_deadline.count());
    text += whyStopping();
    forceHalted({reason, std::move(text)});
}

void Program::takeRest(std::uint32_t stop_request) {
    if (sub_state_ != SubState::stopping || stop_request != execution_->stop_request) {
        return;
    }
    rest_timer_.cancel();
    if (halting_) {
        halted(*halting_);
    } else {
        commit(TransitionNumber::running_to_suspended,
               std::exchange(suspending_, std::nullopt).value_or(Cause{}));
    }
}

void Program::giveUpSuspended() {
    if (work_started_ && !guarded([this] { work_->halt(); })) {
        work_->forceStop();
    }
}

void Program::onControlLost(std::string_view session, OwnerLossAction action,
                            const std::string& text) {
    inCall([this, session = std::string(session), action, text] {
        if (parameters_.isBoundTo(session)) {
            endConfiguration();
        }
        if (work_ && owner_session_ == session) {
            actOnOwnerLoss(action, text);
        }
    });
}

void Program::ownerLost(std::string text, OwnerLossAction action) {
    inCall([this, action, text = std::move(text)]() mutable {
        if (work_) {
            actOnOwnerLoss(action, std::move(text));
        }
    });
}

/// \param action that the owner's lease asks for
void Program::actOnOwnerLoss(OwnerLossAction action, std::string text) {
    for (const auto choice : {on_owner_loss_, action, description_.on_owner_loss}) {
        action = choice;
        if (action != OwnerLossAction::skill_default) {
            break;
        }
    }
    // Even if it goes on, so that the end of the session is not a second loss.
    owner_session_.clear();
    if (action == OwnerLossAction::keep_going) {
        return;
    }
    if (state_ == State::suspended || halting_) {
        return;
    }
    Cause cause{Reason::owner_lost, std::move(text)};
    const bool stopping = sub_state_ == SubState::stopping;
    if (action != OwnerLossAction::suspend || !(stopping || suspendNow(cause))) {
        brake(std::move(cause));
    }
}

void Program::deviceLost(std::string text) {
    inCall([this, cause = Cause{Reason::device_lost, std::move(text)}]() mutable {
        if (work_) {
            forceHalted(std::move(cause));
        } else if (state_ == State::ready) {
            end(TransitionNumber::ready_to_halted, std::move(cause));
        } else {
            reason_ = cause.reason;
            reason_text_ = std::move(cause.text);
            setSubState(SubState::halted_device_lost);
        }
    });
}

void Program::deviceStopped(std::string text) {
    inCall([this, cause = Cause{Reason::error, std::move(text)}]() mutable {
        if (state_ == State::running && !halting_) {
            brake(std::move(cause));
        }
    });
}

void Program::deviceNotReady(std::string text) {
    inCall([this, cause = Cause{Reason::error, std::move(text)}]() mutable {
        if (work_) {
            not_ready_ = std::move(cause);
        } else if (state_ == State::ready) {
            end(TransitionNumber::ready_to_halted, std::move(cause));
        }
    });
}

void Program::deviceReady() {
    inCall([this] { not_ready_.reset(); });
}

void Program::takeProgress(Value intermediate) {
    intermediate_ = std::move(intermediate);
    notify([this](ProgramObserver& observer) { observer.onProgress(intermediate_); });
}

void Program::takeStep(std::string name) {
    step_ = std::move(name);
    if (state_ == State::running) {
        setSubState(sub_state_);
    }
}

}  // namespace metier::skill
