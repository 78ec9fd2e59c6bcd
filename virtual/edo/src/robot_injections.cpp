
#include "robot.hpp"

#include "metier/base/text.hpp"

namespace metier::virtual_edo {
namespace {

using virtual_controller::Injection;
using virtual_controller::InjectionHelp;

// Time for which an injected collision presses on the arm [cycles].
constexpr int kContactCycles = 20;
constexpr std::size_t kMostDropped = 1'000'000;

/// Errors: invalid_argument, with the range.
Result<std::size_t> numberFrom(const Injection& injection, std::size_t low, std::size_t high) {
    const auto number = numberIn<std::size_t>(injection.value);
    if (!number || *number < low || *number > high) {
        return fail(Errc::invalid_argument,
                    fmt::format("{}: \"{}\" is no whole number from {} to {}", injection.name,
                                injection.value, low, high));
    }
    return *number;
}

}  // namespace

std::vector<InjectionHelp> Robot::injections() const {
    return {
        {"emergency-stop", "press the emergency stop: brakes on, no reset works"},
        {"release-emergency-stop", "release it; the brakes stay on until a reset"},
        {"brake", "open the power stages, as the joints do when something is wrong"},
        {"collision", "press on the arm for 0.2 s; noticed unless collision monitoring is off"},
        {"following-error", "AXIS (1 to 6) reports a following error and brakes"},
        {"overcurrent", "AXIS (1 to 6) reports too much current: state ERROR"},
        {"limit", "AXIS (1 to 6) reports the end of its stroke and brakes"},
        {"joint-silent",
         "AXIS (1 to 7) no longer reports; 0: all do again; all: the bus is silent"},
        {"uncalibrate", "the six axes lose their calibration"},
        {"drop-next", "the next N commands (1 to 1000000) are lost without a word"},
        {"lost-part", "the part slips out of the jaws"},
    };
}

Result<void> Robot::inject(const Injection& injection) {
    const auto& name = injection.name;
    if (name == "emergency-stop") {
        bus_.pressEmergencyStop();
    } else if (name == "release-emergency-stop") {
        bus_.releaseEmergencyStop();
    } else if (name == "brake") {
        bus_.brake();
    } else if (name == "collision") {
        contact_left_ = kContactCycles;
    } else if (name == "following-error") {
        return setJointFault(injection, {JointFlag::following_error, JointFlag::power_stage_open});
    } else if (name == "overcurrent") {
        return setJointFault(injection, {JointFlag::overcurrent});
    } else if (name == "limit") {
        return setJointFault(injection, {JointFlag::stroke_end, JointFlag::power_stage_open});
    } else if (name == "joint-silent") {
        return silence(injection);
    } else if (name == "uncalibrate") {
        for (std::size_t axis = 0; axis < kArmAxes; ++axis) {
            bus_.setFlag(axis, JointFlag::uncalibrated);
        }
    } else if (name == "lost-part") {
        part_lost_ = true;
    } else if (name == "drop-next") {
        METIER_ASSIGN(const auto count, numberFrom(injection, 1, kMostDropped));
        commands_to_drop_ = count;
    } else {
        return fail(Errc::not_found, fmt::format("an e.DO has no injection \"{}\"", name));
    }
    return {};
}

Result<void> Robot::setJointFault(const Injection& injection,
                                  std::initializer_list<JointFlag> flags) {
    METIER_ASSIGN(const auto axis, numberFrom(injection, 1, kArmAxes));
    for (const auto flag : flags) {
        bus_.setFlag(axis - 1, flag);
    }
    return {};
}

Result<void> Robot::silence(const Injection& injection) {
    if (injection.value == "all") {
        bus_.silence(0, JointBus::Bus::silent);
        return {};
    }
    METIER_ASSIGN(const auto axis, numberFrom(injection, 0, kMostAxes));
    bus_.silence(axis == 0 ? 0 : std::uint64_t{1} << (axis - 1), JointBus::Bus::speaking);
    return {};
}

}  // namespace metier::virtual_edo
