#pragma once

#include <cstdint>
#include <string_view>

namespace metier::skill {

/// States of a Program, with the numbers of OPC 10000-10.
enum class State : std::uint32_t { halted = 11, ready = 12, running = 13, suspended = 14 };

/// Transitions of a Program, with the numbers of OPC 10000-10.
enum class TransitionNumber : std::uint32_t {
    halted_to_ready = 1,
    ready_to_running = 2,
    running_to_halted = 3,
    running_to_ready = 4,
    running_to_suspended = 5,
    suspended_to_running = 6,
    suspended_to_halted = 7,
    suspended_to_ready = 8,
    ready_to_halted = 9,
};

/// Methods of a Program (OPC 10000-10), and StartWith of metier.
enum class Method : std::uint8_t { start, suspend, resume, halt, reset, start_with };

/// Action of an execution when the client that owns it is gone.
enum class OwnerLossAction : std::uint8_t {
    skill_default,  ///< as the skill's description says
    halt,           ///< brake, then Halted
    suspend,        ///< brake on the path, then Suspended; Halt if the skill cannot be suspended
    keep_going,     ///< go on to the end
};

/// Cause of a transition.
enum class Reason : std::uint8_t {
    none,
    finished,
    by_client,
    error,
    force_exceeded,
    owner_lost,
    device_lost,
    limit_violated,
};

/// The sub-state within the current state. Suspended has none.
enum class SubState : std::uint8_t {
    none,
    ready_not_configured,
    ready_configured,
    executing,
    stopping,
    halted_by_client,
    halted_error,
    halted_force,
    halted_owner_lost,
    halted_device_lost,
    halted_limit,
};

/// Names that clients see: "Halted", "Start", "RunningToHalted", "ReadyConfigured", "ByClient".
std::string_view toString(State state) noexcept;
std::string_view toString(TransitionNumber transition) noexcept;
std::string_view toString(Method method) noexcept;
std::string_view toString(Reason reason) noexcept;
std::string_view toString(SubState sub_state) noexcept;
std::string_view toString(OwnerLossAction action) noexcept;

/// State from which the transition leads.
State fromState(TransitionNumber transition) noexcept;
/// State to which the transition leads.
State toState(TransitionNumber transition) noexcept;

/// Sub-state of Halted that shows `reason`.
SubState haltedBecause(Reason reason) noexcept;

}  // namespace metier::skill
