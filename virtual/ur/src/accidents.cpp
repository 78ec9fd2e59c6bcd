#include <fmt/format.h>

#include "metier/base/text.hpp"
#include "robot.hpp"

namespace metier::virtual_ur {
namespace {

// Codes of the maker's list of errors (assumed).
constexpr int kCollision = 157;

Result<void> exceedLimit(Robot& robot, const std::string& value) {
    const auto axis = value.empty() ? 1 : numberIn<std::size_t>(value).value_or(0);
    if (axis < 1 || axis > kAxes) {
        return fail(Errc::invalid_argument,
                    fmt::format("limit: axis \"{}\" is not within 1 to 6", value));
    }
    robot.exceedLimit(axis - 1);
    return {};
}

}  // namespace

std::vector<virtual_controller::InjectionHelp> accidentsOf(Robot& robot) {
    using virtual_controller::always;
    return {
        {"emergency-stop", "presses the emergency stop; the arm brakes and loses power",
         always([&robot] { robot.emergencyStop(); })},
        {"release-emergency-stop", "pulls it out again; the arm stays without power",
         always([&robot] { robot.releaseEmergencyStop(); })},
        {"protective-stop", "stops the arm as after a collision", always([&robot] {
             robot.protectiveStop({kCollision, "collision detected"});
         })},
        {"limit", "axis 1 to 6 leaves its range; the arm is stopped",
         [&robot](const std::string& value) { return exceedLimit(robot, value); }},
        {"safeguard-stop", "someone opens the safeguard; the arm brakes, the program is paused",
         always([&robot] { robot.safeguardStop(); })},
        {"close-safeguard", "and closes it again", always([&robot] { robot.closeSafeguard(); })},
        {"violation", "the safety system finds a violation; the arm brakes and loses power",
         always([&robot] { robot.violateSafety(); })},
        {"recovery-mode", "an axis is outside of its safety limits; the program ends",
         always([&robot] { robot.enterRecovery(); })},
        {"end-recovery", "someone has moved it back at the pendant",
         always([&robot] { robot.endRecovery(); })},
        {"local-control", "someone switches an e-Series arm to local control",
         always([&robot] { robot.setControl(Control::local); })},
        {"remote-control", "and back", always([&robot] { robot.setControl(Control::remote); })},
        {"program-stop", "someone stops the program at the panel",
         always([&robot] { robot.programs().stop(); })},
    };
}

}  // namespace metier::virtual_ur
