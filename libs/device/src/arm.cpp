#include "metier/device/arm.hpp"

#include <fmt/format.h>

namespace metier::device {

std::string_view toString(SafetyState state) noexcept {
    switch (state) {
        case SafetyState::normal:
            return "normal";
        case SafetyState::protective_stop:
            return "protective stop";
        case SafetyState::emergency_stop:
            return "emergency stop";
        case SafetyState::fault:
            return "fault";
        case SafetyState::disconnected:
            return "disconnected";
    }
    return "unknown";
}

Result<void> checkNormal(const Safety& safety) {
    if (safety.state == SafetyState::normal) {
        return {};
    }
    return fail(Errc::device_fault, fmt::format("{} ({})", safety.text, toString(safety.state)));
}

}  // namespace metier::device
