#include "controller_state.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <string_view>
#include <utility>

namespace metier::ur_driver {

namespace {

template <typename Mode>
using Name = std::pair<Mode, std::string_view>;

constexpr std::array kRobotModes{
    Name<RobotMode>{RobotMode::no_controller, "NO_CONTROLLER"},
    Name<RobotMode>{RobotMode::disconnected, "DISCONNECTED"},
    Name<RobotMode>{RobotMode::confirm_safety, "CONFIRM_SAFETY"},
    Name<RobotMode>{RobotMode::booting, "BOOTING"},
    Name<RobotMode>{RobotMode::power_off, "POWER_OFF"},
    Name<RobotMode>{RobotMode::power_on, "POWER_ON"},
    Name<RobotMode>{RobotMode::idle, "IDLE"},
    Name<RobotMode>{RobotMode::backdrive, "BACKDRIVE"},
    Name<RobotMode>{RobotMode::running, "RUNNING"},
    Name<RobotMode>{RobotMode::updating_firmware, "UPDATING_FIRMWARE"},
};

constexpr std::array kSafetyModes{
    Name<SafetyMode>{SafetyMode::normal, "normal"},
    Name<SafetyMode>{SafetyMode::reduced, "reduced"},
    Name<SafetyMode>{SafetyMode::protective_stop, "protective stop"},
    Name<SafetyMode>{SafetyMode::recovery, "recovery"},
    Name<SafetyMode>{SafetyMode::safeguard_stop, "safeguard stop"},
    Name<SafetyMode>{SafetyMode::system_emergency_stop, "system emergency stop"},
    Name<SafetyMode>{SafetyMode::robot_emergency_stop, "robot emergency stop"},
    Name<SafetyMode>{SafetyMode::violation, "safety violation"},
    Name<SafetyMode>{SafetyMode::fault, "safety fault"},
    Name<SafetyMode>{SafetyMode::validate_joint_id, "validate joint ids"},
    Name<SafetyMode>{SafetyMode::undefined, "undefined safety mode"},
    Name<SafetyMode>{SafetyMode::automatic_mode_safeguard_stop, "automatic mode safeguard stop"},
    Name<SafetyMode>{SafetyMode::system_three_position_enabling_stop,
                     "three-position enabling stop"},
    Name<SafetyMode>{SafetyMode::pendant_three_position_enabling_stop,
                     "three-position enabling stop of the pendant"},
    Name<SafetyMode>{SafetyMode::immi_emergency_stop, "emergency stop of the moulding machine"},
    Name<SafetyMode>{SafetyMode::immi_safeguard_stop, "safeguard stop of the moulding machine"},
    Name<SafetyMode>{SafetyMode::profisafe_waiting, "waiting for PROFIsafe"},
    Name<SafetyMode>{SafetyMode::profisafe_automatic_mode_safeguard_stop,
                     "automatic mode safeguard stop of PROFIsafe"},
    Name<SafetyMode>{SafetyMode::profisafe_safeguard_stop, "safeguard stop of PROFIsafe"},
    Name<SafetyMode>{SafetyMode::profisafe_emergency_stop, "emergency stop of PROFIsafe"},
    Name<SafetyMode>{SafetyMode::safety_api_safeguard_stop, "safeguard stop of the safety API"},
};

constexpr std::array kRuntimeStates{
    Name<RuntimeState>{RuntimeState::stopping, "stopping"},
    Name<RuntimeState>{RuntimeState::stopped, "stopped"},
    Name<RuntimeState>{RuntimeState::playing, "playing"},
    Name<RuntimeState>{RuntimeState::pausing, "pausing"},
    Name<RuntimeState>{RuntimeState::paused, "paused"},
    Name<RuntimeState>{RuntimeState::resuming, "resuming"},
};

template <typename Mode>
std::string nameOf(std::span<const Name<Mode>> names, Mode mode, std::string_view kind) {
    const auto found = std::find_if(names.begin(), names.end(),
                                    [mode](const auto& name) { return name.first == mode; });
    return found == names.end() ? fmt::format("{} {}", kind, static_cast<std::int64_t>(mode))
                                : std::string(found->second);
}

}  // namespace

std::string toText(RobotMode mode) {
    return nameOf<RobotMode>(kRobotModes, mode, "mode");
}

std::string toText(SafetyMode mode) {
    return nameOf<SafetyMode>(kSafetyModes, mode, "safety mode");
}

std::string toText(RuntimeState state) {
    return nameOf<RuntimeState>(kRuntimeStates, state, "state");
}

}  // namespace metier::ur_driver
