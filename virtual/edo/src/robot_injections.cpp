
#include "robot.hpp"

#include "metier/base/text.hpp"

namespace metier::virtual_edo {
namespace {

using namespace virtual_controller;

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

std::vector<InjectionHelp> Robot::injections() {
    return {
        {"emergency-stop", "press the emergency stop: brakes on, no reset works",
         always([this] { bus_.pressEmergencyStop(); })},
        {"release-emergency-stop", "release it; the brakes stay on until a reset",
         always([this] { bus_.releaseEmergencyStop(); })},
        {"brake", "open the power stages, as the joints do when something is wrong",
         always([this] { bus_.brake(); })},
        {"collision", "press on the arm for 0.2 s; noticed unless collision monitoring is off",
         always([this] { contact_left_ = kContactCycles; })},
        jointFault("following-error", "AXIS (1 to 6) reports a following error and brakes",
                   {JointFlag::following_error, JointFlag::power_stage_open}),
        jointFault("overcurrent", "AXIS (1 to 6) reports too much current: state ERROR",
                   {JointFlag::overcurrent}),
        jointFault("limit", "AXIS (1 to 6) reports the end of its stroke and brakes",
                   {JointFlag::stroke_end, JointFlag::power_stage_open}),
        {"joint-silent", "AXIS (1 to 7) no longer reports; 0: all do again; all: the bus is silent",
         [this](const std::string& value) {
             return silence({"joint-silent", value});
         }},
        {"uncalibrate", "the six axes lose their calibration", always([this] {
             for (std::size_t axis = 0; axis < kArmAxes; ++axis) {
                 bus_.setFlag(axis, JointFlag::uncalibrated);
             }
         })},
        {"drop-next", "the next N commands (1 to 1000000) are lost without a word",
         [this](const std::string& value) {
             return numberFrom({"drop-next", value}, 1, kMostDropped).map([this](auto count) {
                 commands_to_drop_ = count;
             });
         }},
        {"lost-part", "the part slips out of the jaws", always([this] { part_lost_ = true; })},
    };
}

InjectionHelp Robot::jointFault(const char* name, const char* help, std::vector<JointFlag> flags) {
    return {name, help, [this, name, flags = std::move(flags)](const std::string& value) {
                return numberFrom({name, value}, 1, kArmAxes).map([&](std::size_t axis) {
                    for (const auto flag : flags) {
                        bus_.setFlag(axis - 1, flag);
                    }
                });
            }};
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
