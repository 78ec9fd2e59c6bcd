#pragma once

#include <cstdint>
#include <string_view>

namespace metier::skill {

/// States of a Program, with the numbers of OPC 10000-10.
enum class State : std::uint32_t {
    /// Stands still after a Halt or fault; Reset makes it Ready, if the device agrees.
    halted = 11,
    /// Stands still; Start begins an execution.
    ready = 12,
    /// Executes, or brakes to come to rest.
    running = 13,
    /// Stands still on its path; Resume continues.
    suspended = 14
};

/// Transitions of a Program, with the numbers of OPC 10000-10 and what causes them.
enum class TransitionNumber : std::uint32_t {
    /// Reset, if the device agrees.
    halted_to_ready = 1,
    /// Start, StartWith.
    ready_to_running = 2,
    /// Halt, an error, loss of the owner or of the device.
    running_to_halted = 3,
    /// The skill finished.
    running_to_ready = 4,
    /// Suspend, or a loss of the owner that asks for it.
    running_to_suspended = 5,
    /// Resume.
    suspended_to_running = 6,
    /// Halt, an error, loss of the device.
    suspended_to_halted = 7,
    /// Reset: the execution is given up.
    suspended_to_ready = 8,
    /// Halt, or the device was stopped or lost.
    ready_to_halted = 9,
};

/// Methods of a Program (OPC 10000-10), and StartWith of metier: a Start with its parameters.
enum class Method : std::uint8_t { start, suspend, resume, halt, reset, start_with };

/// Action of an execution when the client that owns it is gone; OwnerLossAction of the NodeSet.
enum class OwnerLossAction : std::uint8_t {
    /// As the skill's description says.
    skill_default = 0,
    /// Brake, then Halted.
    halt = 1,
    /// Brake on the path, then Suspended; Halt if the skill cannot be suspended.
    suspend = 2,
    /// Go on to the end; shown to clients as "Continue".
    keep_going = 3,
};

/// Cause of a transition; shown to clients in its event; SkillTransitionReason of the NodeSet.
enum class Reason : std::uint8_t {
    /// No transition yet.
    none = 0,
    /// The skill has reached its end: the result is complete.
    finished = 1,
    /// A Method of a client.
    by_client = 2,
    /// A fault of the device or the skill; the reason's text has it.
    error = 3,
    /// A contact force over its limit.
    force_exceeded = 4,
    /// The session of the owner has ended, or its lease has run out.
    owner_lost = 5,
    /// The connection to the device is lost, or to the server of a part.
    device_lost = 6,
    /// A limit of the device was exceeded, such as a set-point beyond it.
    limit_violated = 7,
};

/// The sub-state within the current state; the sub-states of the other states are
/// BadStateNotActive. Suspended has none.
enum class SubState : std::uint8_t {
    /// No sub-state: Suspended.
    none,
    /// Ready: all parameters have their defaults, and any session may write.
    ready_not_configured,
    /// Ready: a session has written, and the parameters are bound to it.
    ready_configured,
    /// Running: the work goes on.
    executing,
    /// Running: the work comes to rest for a Suspend or Halt.
    stopping,
    /// Halted by the Halt of a client.
    halted_by_client,
    /// Halted by a fault.
    halted_error,
    /// Halted by a contact force over its limit.
    halted_force,
    /// Halted since the owner was lost.
    halted_owner_lost,
    /// Halted since the device was lost.
    halted_device_lost,
    /// Halted since a limit was exceeded.
    halted_limit,
};

/// Name that clients see: "Halted". Valid for ever, as are those below; a number outside the enum
/// gives "unknown", but a TransitionNumber must be one of the enum.
std::string_view toString(State state) noexcept;
/// Name that clients see: "RunningToHalted".
std::string_view toString(TransitionNumber transition) noexcept;
/// Name that clients see: "Start".
std::string_view toString(Method method) noexcept;
/// Name that clients see: "ByClient".
std::string_view toString(Reason reason) noexcept;
/// Name that clients see: "ReadyConfigured".
std::string_view toString(SubState sub_state) noexcept;
/// Name that clients see: "SkillDefault".
std::string_view toString(OwnerLossAction action) noexcept;

/// State from which the transition leads.
State fromState(TransitionNumber transition) noexcept;
/// State to which the transition leads.
State toState(TransitionNumber transition) noexcept;

/// Sub-state of Halted that shows `reason`; halted_error for a reason that has none of its own.
SubState haltedBecause(Reason reason) noexcept;

}  // namespace metier::skill
