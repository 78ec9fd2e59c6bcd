#include "metier/device/arm.hpp"

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

}  // namespace metier::device
