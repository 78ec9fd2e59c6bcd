#include "accidents.hpp"

#include <fmt/format.h>

#include <array>

#include "metier/base/text.hpp"

namespace metier::virtual_ur {

namespace {

// Codes of the maker's list of errors (assumed).
constexpr int kCollision = 157;

/// One that cannot be refused.
template <auto Happen>
Result<void> always(Robot& robot, const std::string& /*value*/) {
    Happen(robot);
    return {};
}

Result<void> exceedLimit(Robot& robot, const std::string& value) {
    const auto axis = value.empty() ? 1 : numberIn<std::size_t>(value).value_or(0);
    if (axis < 1 || axis > kAxes) {
        return fail(Errc::invalid_argument,
                    fmt::format("limit: axis \"{}\" is not within 1 to 6", value));
    }
    robot.exceedLimit(axis - 1);
    return {};
}

constexpr std::array kAccidents{
    Accident{"emergency-stop", "presses the emergency stop; the arm brakes and loses power",
             always<[](Robot& robot) { robot.emergencyStop(); }>},
    Accident{"release-emergency-stop", "pulls it out again; the arm stays without power",
             always<[](Robot& robot) { robot.releaseEmergencyStop(); }>},
    Accident{"protective-stop", "stops the arm as after a collision", always<[](Robot& robot) {
                 robot.protectiveStop({kCollision, "collision detected"});
             }>},
    Accident{"limit", "axis 1 to 6 leaves its range; the arm is stopped", exceedLimit},
    Accident{"safeguard-stop", "someone opens the safeguard; the arm brakes, the program is paused",
             always<[](Robot& robot) { robot.safeguardStop(); }>},
    Accident{"close-safeguard", "and closes it again",
             always<[](Robot& robot) { robot.closeSafeguard(); }>},
    Accident{"violation", "the safety system finds a violation; the arm brakes and loses power",
             always<[](Robot& robot) { robot.violateSafety(); }>},
    Accident{"recovery-mode", "an axis is outside of its safety limits; the program ends",
             always<[](Robot& robot) { robot.enterRecovery(); }>},
    Accident{"end-recovery", "someone has moved it back at the pendant",
             always<[](Robot& robot) { robot.endRecovery(); }>},
    Accident{"local-control", "someone switches an e-Series arm to local control",
             always<[](Robot& robot) { robot.setControl(Control::local); }>},
    Accident{"remote-control", "and back",
             always<[](Robot& robot) { robot.setControl(Control::remote); }>},
    Accident{"program-stop", "someone stops the program at the panel",
             always<[](Robot& robot) { robot.programs().stop(); }>},
};

}  // namespace

std::span<const Accident> accidents() {
    return kAccidents;
}

}  // namespace metier::virtual_ur
