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
struct ExecutionRecord;

/// What the event of a transition tells.
struct TransitionEvent {
    TransitionNumber number = TransitionNumber::halted_to_ready;
    State from = State::halted;
    State to = State::ready;
    UtcTime time{};
    std::string execution_id{};  ///< of the execution concerned; empty if there is none
    Reason reason = Reason::none;
    std::string reason_text{};    ///< for a person; empty if the reason says it all
    Value intermediate_result{};  ///< the last one of the execution; Null if there was none
    std::string message{};
    std::uint16_t severity = 0;  ///< 1 to 1000, as OPC 10000-5 grades it
};

/// The work of a Program begins to come to rest; the transition to `to` follows at standstill.
struct StoppingEvent {
    UtcTime time{};
    std::string execution_id{};
    State to = State::halted;  ///< Halted or Suspended
    Reason reason = Reason::by_client;
    std::string reason_text{};  ///< who asked for it, or what is wrong, for a person
};

/// Who did what last to a Program: ProgramDiagnostic of OPC 10000-10.
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
/// One transition is told in one go, and its event last: onResult (if the work finished),
/// onSubState, onReason, onDiagnostic, onTransition. Parameters that fall back follow.
/// Threading: the owner's thread. From inside a call the Program may be read; a command to it is
/// refused with invalid_state.
class ProgramObserver {
public:
    virtual ~ProgramObserver() = default;
    /// State variables are to be set and the event raised.
    virtual void onTransition(const TransitionEvent& /*event*/) {}
    /// \param step of a sequence; empty if it has none
    virtual void onSubState(SubState /*sub_state*/, std::string_view /*step*/) {}
    /// Why the Program is where it is, or why a Reset was refused.
    virtual void onReason(Reason /*reason*/, std::string_view /*text*/) {}
    /// A value was written, or fell back to its default.
    virtual void onParameter(std::string_view /*name*/, const Value& /*value*/) {}
    /// The result of an execution that finished: every declared field.
    virtual void onResult(const ValueMap& /*result*/) {}
    virtual void onProgress(const Value& /*intermediate*/) {}
    virtual void onDiagnostic(const Diagnostic& /*diagnostic*/) {}
    /// The work begins to come to rest. Again, if a Halt follows a Suspend before standstill.
    virtual void onStopping(const StoppingEvent& /*event*/) {}
    /// An execution begins; its transition to Running follows.
    virtual void onBegin(const ExecutionRecord& /*execution*/) {}
    /// The execution that is under way has started another one.
    virtual void onStarted(const StartedExecution& /*child*/) {}
    /// Somebody asked what Start would say. Nothing has changed.
    virtual void onCheck(const Caller& /*caller*/, const ValueMap& /*parameters*/,
                         const CheckReport& /*report*/) {}
};

}  // namespace metier::skill
