#include "metier/skill/state.hpp"

#include <array>
#include <initializer_list>

namespace metier::skill {

namespace {

struct Ends {
    State from;
    State to;
    std::string_view name;
};

constexpr std::array<Ends, 9> kTransitions{{
    {State::halted, State::ready, "HaltedToReady"},
    {State::ready, State::running, "ReadyToRunning"},
    {State::running, State::halted, "RunningToHalted"},
    {State::running, State::ready, "RunningToReady"},
    {State::running, State::suspended, "RunningToSuspended"},
    {State::suspended, State::running, "SuspendedToRunning"},
    {State::suspended, State::halted, "SuspendedToHalted"},
    {State::suspended, State::ready, "SuspendedToReady"},
    {State::ready, State::halted, "ReadyToHalted"},
}};

constexpr const Ends& endsOf(TransitionNumber transition) noexcept {
    return kTransitions[static_cast<std::size_t>(transition) - 1];
}

template <typename Enum>
std::string_view nameOf(Enum value, std::initializer_list<std::string_view> names,
                        Enum first = {}) noexcept {
    const auto index = static_cast<std::size_t>(value) - static_cast<std::size_t>(first);
    return index < names.size() ? names.begin()[index] : "unknown";
}

}  // namespace

std::string_view toString(State state) noexcept {
    return nameOf(state, {"Halted", "Ready", "Running", "Suspended"}, State::halted);
}

std::string_view toString(TransitionNumber transition) noexcept {
    return endsOf(transition).name;
}

std::string_view toString(Method method) noexcept {
    return nameOf(method, {"Start", "Suspend", "Resume", "Halt", "Reset", "StartWith"});
}

std::string_view toString(OwnerLossAction action) noexcept {
    return nameOf(action, {"SkillDefault", "Halt", "Suspend", "Continue"});
}

std::string_view toString(Reason reason) noexcept {
    return nameOf(reason, {"None", "Finished", "ByClient", "Error", "ForceExceeded", "OwnerLost",
                           "DeviceLost", "LimitViolated"});
}

std::string_view toString(SubState sub_state) noexcept {
    return nameOf(sub_state, {"None", "ReadyNotConfigured", "ReadyConfigured", "Executing",
                              "Stopping", "HaltedByClient", "HaltedError", "HaltedForce",
                              "HaltedOwnerLost", "HaltedDeviceLost", "HaltedLimit"});
}

State fromState(TransitionNumber transition) noexcept {
    return endsOf(transition).from;
}

State toState(TransitionNumber transition) noexcept {
    return endsOf(transition).to;
}

SubState haltedBecause(Reason reason) noexcept {
    switch (reason) {
        case Reason::by_client:
            return SubState::halted_by_client;
        case Reason::force_exceeded:
            return SubState::halted_force;
        case Reason::owner_lost:
            return SubState::halted_owner_lost;
        case Reason::device_lost:
            return SubState::halted_device_lost;
        case Reason::limit_violated:
            return SubState::halted_limit;
        default:
            return SubState::halted_error;
    }
}

}  // namespace metier::skill
