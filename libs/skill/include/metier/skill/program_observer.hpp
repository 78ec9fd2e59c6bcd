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

/// Content of a transition's event.
struct TransitionEvent {
    TransitionNumber number = TransitionNumber::halted_to_ready;
    State from = State::halted;
    State to = State::ready;
    UtcTime time{};
    std::string execution_id{};  ///< execution concerned; empty if there is none
    Reason reason = Reason::none;
    std::string reason_text{};    ///< for a person; empty if the reason says it all
    Value intermediate_result{};  ///< latest one of the execution; Null: none
    std::string message{};        ///< text of the event, for a person
    std::uint16_t severity = 0;   ///< 1 to 1000, as OPC 10000-5 grades it
};

/// The work begins to come to rest; the transition to `to` follows at standstill.
struct StoppingEvent {
    UtcTime time{};
    std::string execution_id{};  ///< execution that comes to rest
    State to = State::halted;    ///< Halted or Suspended
    Reason reason = Reason::by_client;
    std::string reason_text{};  ///< client that asked for it, or the error; for a person
};

/// Last call of a Program and its caller: ProgramDiagnostic of OPC 10000-10.
struct Diagnostic {
    std::string create_session_id{};  ///< empty: the server made the Program itself
    std::string create_client_name{};
    UtcTime invocation_creation_time{};
    UtcTime last_transition_time{};  ///< the epoch before the first transition
    std::string last_method_call{};  ///< "Start"; empty before the first call
    std::string last_method_session_id{};
    std::string last_method_client_name{};
    ValueMap last_method_inputs{};  ///< for Start, the parameters that its client had written
    UtcTime last_method_call_time{};
    Result<void> last_method_status{};  ///< refused calls count too
};

/// Observer of a Program; each function does nothing unless it is overridden.
///
/// A transition is reported by several calls in a row, its event last: onSubState, onDiagnostic,
/// onTransition.
/// Threading: the owner's thread. From inside a call the Program may be read; a command to it is
/// refused with invalid_state.
class ProgramObserver {
public:
    virtual ~ProgramObserver() = default;
    /// The state has changed: the observer sets the state variables and raises the event.
    virtual void onTransition(const TransitionEvent& /*event*/) {}
    /// \param step of a sequence; empty if it has none
    virtual void onSubState(SubState /*sub_state*/, std::string_view /*step*/) {}
    /// The latest intermediate result of the execution under way.
    virtual void onProgress(const Value& /*intermediate*/) {}
    /// A method was called, or a state changed: the new content of ProgramDiagnostic.
    virtual void onDiagnostic(const Diagnostic& /*diagnostic*/) {}
    /// The work begins to come to rest. Called again if a Halt follows a Suspend before standstill.
    virtual void onStopping(const StoppingEvent& /*event*/) {}
    /// The execution that is under way has started another one.
    virtual void onStarted(const StartedExecution& /*child*/) {}
    /// A client called Check. Nothing has changed.
    virtual void onCheck(const Caller& /*caller*/, const ValueMap& /*parameters*/,
                         const CheckReport& /*report*/) {}
};

}  // namespace metier::skill
