#include "controller_state.hpp"

#include <fmt/format.h>

#include <array>
#include <span>
#include <string_view>

namespace metier::ur_driver {

namespace {

// Names by number from the first on; empty for a number without meaning.
constexpr std::int64_t kFirstRobotMode = -1;
constexpr std::array<std::string_view, 10> kRobotModes{
    "NO_CONTROLLER", "DISCONNECTED", "CONFIRM_SAFETY", "BOOTING", "POWER_OFF",
    "POWER_ON",      "IDLE",         "BACKDRIVE",      "RUNNING", "UPDATING_FIRMWARE"};

constexpr std::int64_t kFirstSafetyMode = 1;
constexpr std::array<std::string_view, 22> kSafetyModes{
    "normal",
    "reduced",
    "protective stop",
    "recovery",
    "safeguard stop",
    "system emergency stop",
    "robot emergency stop",
    "safety violation",
    "safety fault",
    "validate joint ids",
    "undefined safety mode",
    "automatic mode safeguard stop",
    "three-position enabling stop",
    "three-position enabling stop of the pendant",
    "emergency stop of the moulding machine",
    "safeguard stop of the moulding machine",
    "waiting for PROFIsafe",
    "automatic mode safeguard stop of PROFIsafe",
    "safeguard stop of PROFIsafe",
    "emergency stop of PROFIsafe",
    "",
    "safeguard stop of the safety API"};

constexpr std::array<std::string_view, 6> kRuntimeStates{"stopping", "stopped", "playing",
                                                         "pausing",  "paused",  "resuming"};

std::string nameOf(std::span<const std::string_view> names, std::int64_t index,
                   const std::string& otherwise) {
    const bool known = index >= 0 && index < std::ssize(names);
    const auto name = known ? names[static_cast<std::size_t>(index)] : std::string_view();
    return name.empty() ? otherwise : std::string(name);
}

}  // namespace

std::string toText(RobotMode mode) {
    const auto number = static_cast<std::int64_t>(mode);
    return nameOf(kRobotModes, number - kFirstRobotMode, fmt::format("mode {}", number));
}

std::string toText(SafetyMode mode) {
    const auto number = static_cast<std::int64_t>(mode);
    return nameOf(kSafetyModes, number - kFirstSafetyMode, fmt::format("safety mode {}", number));
}

std::string toText(RuntimeState state) {
    const auto number = static_cast<std::int64_t>(state);
    return nameOf(kRuntimeStates, number, fmt::format("state {}", number));
}

}  // namespace metier::ur_driver
