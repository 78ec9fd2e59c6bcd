#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"
#include "metier/skill/caller.hpp"
#include "metier/skill/parent_execution.hpp"
#include "metier/skill/state.hpp"
#include "metier/skill/value.hpp"

namespace metier::skill {

struct CheckReport;

/// Content of a transition's event, as SkillTransitionEventType shows it.
struct TransitionEvent {
    /// The transition, with its number in OPC 10000-10.
    TransitionNumber number = TransitionNumber::halted_to_ready;
    /// State before and state after it.
    State from = State::halted;
    /// State after it.
    State to = State::ready;
    /// Server's wall clock when the state changed.
    UtcTime time{};
    /// Execution concerned; empty if there is none.
    std::string execution_id{};
    /// Cause; by_client also for a Reset and a Start.
    Reason reason = Reason::none;
    /// Text for a person; empty if the reason says it all.
    std::string reason_text{};
    /// Latest intermediate result of the execution; Null: none.
    Value intermediate_result{};
    /// Text of the event, for a person: skill, both states and the reason's text.
    std::string message{};
    /// Severity of OPC 10000-5, 1 to 1000: 700 Halted by a fault, 400 Halted by a client, 100 all
    /// else.
    std::uint16_t severity = 0;
};

/// Content of the event that the work begins to come to rest; the transition to `to` follows at
/// standstill.
struct StoppingEvent {
    /// Server's wall clock when the work was asked.
    UtcTime time{};
    /// Execution that comes to rest.
    std::string execution_id{};
    /// State at standstill: Halted or Suspended.
    State to = State::halted;
    /// Cause: by_client, or the fault or loss that stops it.
    Reason reason = Reason::by_client;
    /// Client that asked for it, or the error; for a person.
    std::string reason_text{};
};

/// Last call of a Program and its caller: ProgramDiagnostic of OPC 10000-10. Times are the server's
/// wall clock.
struct Diagnostic {
    /// Session that made the Program; empty: the server itself.
    std::string create_session_id{};
    /// Application name of that session's client.
    std::string create_client_name{};
    /// Time at which the Program was made.
    UtcTime invocation_creation_time{};
    /// Time of the last transition; UtcTime{} before the first.
    UtcTime last_transition_time{};
    /// Name of the Method that was called last: "Start"; empty before the first call.
    std::string last_method_call{};
    /// Session and application name of its caller.
    std::string last_method_session_id{};
    /// Application name of its client.
    std::string last_method_client_name{};
    /// For Start, the parameters that its client had written; for StartWith, those that it was
    /// given.
    ValueMap last_method_inputs{};
    /// Time of that call.
    UtcTime last_method_call_time{};
    /// Outcome of that call; refused calls count, too.
    Result<void> last_method_status{};
};

/// Observer of a Program; each function does nothing unless it is overridden. It must be detached
/// before its life ends, unless it outlives the Program.
///
/// A transition is reported by several calls in a row, its event last: onSubState, onDiagnostic,
/// onTransition.
/// Threading: the owner's thread; must not block. From inside a call the Program may be read; a
/// command to it is refused with invalid_state.
class ProgramObserver {
public:
    virtual ~ProgramObserver() = default;
    /// Reports that the state has changed: the observer sets the state variables and raises the
    /// event.
    virtual void onTransition(const TransitionEvent& /*event*/) {}
    /// Reports the sub-state; also called when only the step has changed.
    /// \param step present step of a sequence; empty if it has none or is not Running
    virtual void onSubState(SubState /*sub_state*/, std::string_view /*step*/) {}
    /// Reports the latest intermediate result of the execution under way.
    virtual void onProgress(const Value& /*intermediate*/) {}
    /// Reports the new content of ProgramDiagnostic: a method was called, or a state has changed.
    virtual void onDiagnostic(const Diagnostic& /*diagnostic*/) {}
    /// Reports that the work begins to come to rest. Called again if a Halt follows a Suspend
    /// before standstill.
    virtual void onStopping(const StoppingEvent& /*event*/) {}
    /// Reports that the execution under way has started another one.
    virtual void onStarted(const StartedExecution& /*child*/) {}
    /// Reports that a client called Check, with the answer that it gets. Nothing has changed.
    virtual void onCheck(const Caller& /*caller*/, const ValueMap& /*parameters*/,
                         const CheckReport& /*report*/) {}
};

}  // namespace metier::skill
