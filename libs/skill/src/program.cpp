#include "metier/skill/program.hpp"

#include <fmt/format.h>

#include <stdexcept>
#include <utility>

#include "metier/base/random.hpp"
#include "program_call.hpp"

namespace metier::skill {

namespace {

constexpr std::uint16_t kInformation = 100;
constexpr std::uint16_t kWarning = 400;
constexpr std::uint16_t kFault = 700;

constexpr std::size_t kBootIdDigits = 16;

std::uint16_t severityOf(State to, Reason reason) noexcept {
    if (to != State::halted) {
        return kInformation;
    }
    return reason == Reason::by_client ? kWarning : kFault;
}

SubState subStateAfter(State to, Reason reason) noexcept {
    switch (to) {
        case State::ready:
            return SubState::ready_not_configured;
        case State::running:
            return SubState::executing;
        case State::suspended:
            return SubState::none;
        case State::halted:
            break;
    }
    return haltedBecause(reason);
}

std::string messageOf(std::string_view name, TransitionNumber transition, std::string_view text) {
    return fmt::format("{}: {} to {}{}{}", name, toString(fromState(transition)),
                       toString(toState(transition)), text.empty() ? "" : ": ", text);
}

void checkFields(const Fields& fields) {
    for (auto field = fields.begin(); field != fields.end(); ++field) {
        if (const auto checked = checkValue(*field, field->default_value); !checked) {
            throw std::invalid_argument("default of " + checked.error().message);
        }
        for (auto other = fields.begin(); other != field; ++other) {
            if (other->name == field->name) {
                throw std::invalid_argument("two fields are called " + field->name);
            }
        }
    }
}

std::unique_ptr<Skill> checkedSkill(std::unique_ptr<Skill> skill) {
    if (!skill) {
        throw std::invalid_argument("a Program needs a skill");
    }
    checkFields(skill->description().parameters);
    checkFields(skill->description().results);
    return skill;
}

ValueMap nullResult(const Fields& fields) {
    ValueMap result;
    for (const auto& field : fields) {
        result.emplace(field.name, Value{});
    }
    return result;
}

}  // namespace

Program::Program(ProgramOptions options, std::unique_ptr<Skill> skill,
                 std::shared_ptr<Executor> executor, const Clock& clock)
    : options_(std::move(options)),
      skill_(checkedSkill(std::move(skill))),
      description_(skill_->description()),
      executor_(std::move(executor)),
      clock_(clock),
      parameters_(description_.parameters),
      final_result_(nullResult(description_.results)),
      boot_id_(randomHex(kBootIdDigits)) {
    diagnostic_.create_session_id = options_.creator.session_id;
    diagnostic_.create_client_name = options_.creator.client_name;
    diagnostic_.invocation_creation_time = clock_.utcNow();
    if (!options_.names) {
        options_.names = std::make_shared<ExecutionNames>();
    }
    if (options_.control) {
        options_.control->attach(*this);
    }
}

Program::~Program() {
    if (options_.control) {
        options_.control->detach(*this);
    }
    busy_ = true;
    if (work_started_ && state_ == State::running) {
        work_->forceStop();
    }
    endExecution();
}

void Program::attach(ProgramObserver& observer) {
    observers_.push_back(&observer);
}

void Program::detach(ProgramObserver& observer) {
    std::erase(observers_, &observer);
}

template <typename Work>
Result<void> Program::command(Method method, const Caller& caller, Work work) {
    if (busy_) {
        return metier::fail(Errc::invalid_state,
                            fmt::format("{} from inside a notification", toString(method)));
    }
    const Call call(*this);
    recordCall(method, caller);
    auto status = checkAllowed(method, caller);
    if (status) {
        status = work();
    }
    recordStatus(status);
    return status;
}

Result<void> Program::checkAllowed(Method method, const Caller& caller) const {
    if (!allows(method)) {
        return metier::fail(
            Errc::invalid_state,
            fmt::format("{} is not possible while {}{}", toString(method),
                        sub_state_ == SubState::stopping ? toString(sub_state_) : toString(state_),
                        wayOut()));
    }
    return method == Method::halt ? Result<void>{} : checkControl(caller);
}

/// For refusals: why it is Halted, and what makes it Ready; empty in all other states.
std::string Program::wayOut() const {
    if (state_ != State::halted) {
        return {};
    }
    return fmt::format(" ({}{}{}); Reset makes it Ready", toString(reason_),
                       reason_text_.empty() ? "" : ": ", reason_text_);
}

Result<void> Program::checkControl(const Caller& caller) const {
    return options_.control ? options_.control->checkCommand(caller) : Result<void>{};
}

bool Program::allows(Method method) const noexcept {
    switch (method) {
        case Method::start:
        case Method::start_with:
            return state_ == State::ready;
        case Method::suspend:
            return sub_state_ == SubState::executing;
        case Method::resume:
            return state_ == State::suspended;
        case Method::halt:
            return state_ != State::halted;
        case Method::reset:
            return state_ == State::halted || state_ == State::suspended;
    }
    return false;
}

bool Program::executable(Method method, const Caller& caller) const {
    if (!checkAllowed(method, caller)) {
        return false;
    }
    switch (method) {
        case Method::start:
        case Method::start_with:
            return checkFree(caller).has_value();
        case Method::suspend:
            return description_.suspendable;
        default:
            return true;
    }
}

void Program::recordCall(Method method, const Caller& caller) {
    diagnostic_.last_method_call = toString(method);
    diagnostic_.last_method_session_id = caller.session_id;
    diagnostic_.last_method_client_name = caller.client_name;
    diagnostic_.last_method_inputs = method == Method::start ? parameters_.written() : ValueMap{};
    diagnostic_.last_method_call_time = clock_.utcNow();
    diagnostic_.last_method_status = {};
    diagnostic_reported_ = false;
}

void Program::recordStatus(const Result<void>& status) {
    if (status && diagnostic_reported_) {
        return;
    }
    diagnostic_.last_method_status = status;
    notify([this](ProgramObserver& observer) { observer.onDiagnostic(diagnostic_); });
}

Result<void> Program::start(const Caller& caller) {
    return command(Method::start, caller, [&]() -> Result<void> {
        METIER_TRY(checkFree(caller));
        METIER_TRY(parameters_.checkComplete());
        return begin(caller, parameters_.snapshot(), {});
    });
}

Result<std::string> Program::startWith(const Caller& caller, StartRequest request) {
    if (!request.execution_id.empty() && history_.find(request.execution_id) != nullptr) {
        return request.execution_id;
    }
    METIER_TRY(command(Method::start_with, caller, [&] { return startWithNow(caller, request); }));
    return request.execution_id;
}

Result<ExecutionRecord> Program::execution(std::string_view id) const {
    if (const auto* record = history_.find(id)) {
        return *record;
    }
    const bool forgotten = options_.names->knows(description_.name, id);
    return metier::fail(Errc::not_found,
                        fmt::format("{}: {}", description_.name,
                                    forgotten ? forgottenText(id)
                                              : fmt::format("no execution \"{}\" is known", id)));
}

Result<void> Program::suspend(const Caller& caller) {
    return command(Method::suspend, caller, [this] { return suspendNow({}); });
}

Result<void> Program::resume(const Caller& caller) {
    return command(Method::resume, caller, [&] { return resumeNow(caller); });
}

Result<void> Program::halt(const Caller& caller) {
    return command(Method::halt, caller, [this]() -> Result<void> {
        if (state_ == State::ready) {
            end(TransitionNumber::ready_to_halted, {});
        } else if (state_ == State::suspended) {
            giveUpSuspended();
            halted({});
        } else if (!halting_) {
            brake({});
        }
        return {};
    });
}

Result<void> Program::reset(const Caller& caller) {
    return command(Method::reset, caller, [this]() -> Result<void> {
        if (state_ == State::suspended) {
            giveUpSuspended();
            end(TransitionNumber::suspended_to_ready, {});
            return {};
        }
        if (auto agreed = guarded([this] { return skill_->reset(); }); !agreed) {
            reason_text_ = agreed.error().message;
            return agreed;
        }
        commit(TransitionNumber::halted_to_ready, {});
        return {};
    });
}

void Program::setSubState(SubState sub_state) {
    sub_state_ = sub_state;
    notify([this](ProgramObserver& observer) {
        observer.onSubState(sub_state_, state_ == State::running ? step_ : std::string_view{});
    });
}

void Program::noteInHistory() {
    if (!execution_) {
        return;
    }
    auto& record = history_.last();
    record.state = state_;
    record.reason = reason_;
    record.reason_text = reason_text_;
    if (!work_) {
        record.end_time = diagnostic_.last_transition_time;
    }
    if (reason_ == Reason::finished) {
        record.result = final_result_;
    }
}

/// The one place where the state changes.
void Program::commit(TransitionNumber transition, Cause cause) {
    state_ = toState(transition);
    reason_ = cause.reason;
    reason_text_ = std::move(cause.text);
    diagnostic_.last_transition_time = clock_.utcNow();
    diagnostic_reported_ = true;
    last_ = TransitionEvent{
        .number = transition,
        .from = fromState(transition),
        .to = state_,
        .time = diagnostic_.last_transition_time,
        .execution_id = execution_ ? execution_->id : std::string{},
        .reason = reason_,
        .reason_text = reason_text_,
        .intermediate_result = intermediate_,
        .message = messageOf(description_.name, transition, reason_text_),
        .severity = severityOf(state_, reason_),
    };
    noteInHistory();
    if (!work_) {
        execution_.reset();
        intermediate_ = {};
        step_.clear();
    }
    setSubState(subStateAfter(state_, reason_));
    notify([this](ProgramObserver& observer) {
        observer.onDiagnostic(diagnostic_);
        observer.onTransition(*last_);
    });
}

}  // namespace metier::skill
