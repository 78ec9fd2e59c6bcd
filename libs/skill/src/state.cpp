#include "metier/skill/state.hpp"

#include <array>

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

template <typename Enum, std::size_t size>
std::string_view nameOf(Enum value, const std::array<std::string_view, size>& all,
                        std::size_t first = 0) noexcept {
    const auto index = static_cast<std::size_t>(value) - first;
    return index < size ? all[index] : "unknown";
}

}  // namespace

std::string_view toString(State state) noexcept {
    static constexpr std::array<std::string_view, 4> names{"Halted", "Ready", "Running",
                                                           "Suspended"};
    return nameOf(state, names, static_cast<std::size_t>(State::halted));
}

std::string_view toString(TransitionNumber transition) noexcept {
    return endsOf(transition).name;
}

std::string_view toString(Method method) noexcept {
    static constexpr std::array<std::string_view, 6> names{"Start", "Suspend", "Resume",
                                                           "Halt",  "Reset",   "StartWith"};
    return nameOf(method, names);
}

std::string_view toString(OwnerLossAction action) noexcept {
    static constexpr std::array<std::string_view, 4> names{"SkillDefault", "Halt", "Suspend",
                                                           "Continue"};
    return nameOf(action, names);
}

std::string_view toString(Reason reason) noexcept {
    static constexpr std::array<std::string_view, 8> names{
        "None",          "Finished",  "ByClient",   "Error",
        "ForceExceeded", "OwnerLost", "DeviceLost", "LimitViolated"};
    return nameOf(reason, names);
}

std::string_view toString(SubState sub_state) noexcept {
    static constexpr std::array<std::string_view, 11> names{"None",
                                                            "ReadyNotConfigured",
                                                            "ReadyConfigured",
                                                            "Executing",
                                                            "Stopping",
                                                            "HaltedByClient",
                                                            "HaltedError",
                                                            "HaltedForce",
                                                            "HaltedOwnerLost",
                                                            "HaltedDeviceLost",
                                                            "HaltedLimit"};
    return nameOf(sub_state, names);
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
        case Reason::none:
        case Reason::finished:
        case Reason::error:
            break;
    }
    return SubState::halted_error;
}

}  // namespace metier::skill
