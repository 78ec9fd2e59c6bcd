// What can be planned for which kinematic structure, in words.

#include <fmt/format.h>

#include "metier/robot_files/import.hpp"

namespace metier::robot_files {

namespace {

using motion::IkKind;

std::string closedForm(const motion::Kinematics& kinematics) {
    const std::string all = "all moves can be planned; inverse kinematics in closed form: ";
    switch (kinematics.ikKind()) {
        case IkKind::three_parallel_axes:
            return all + "axes 2, 3 and 4 are parallel, 5 and 6 meet" +
                   (kinematics.isCalibrated() ? " (nearly; refined by iteration)" : "");
        case IkKind::spherical_wrist:
            return all + "axes 2 and 3 are parallel; 4, 5 and 6 meet in a point";
        case IkKind::arm_angle:
            return all + "axes 1, 2 and 3 meet in a point, and so do 5, 6 and 7";
        case IkKind::numeric:
            break;
    }
    return {};
}

}  // namespace

std::string planningOf(const motion::RobotModel& model) {
    constexpr std::size_t for_every_pose = 6;
    const auto& kinematics = model.kinematics();
    if (kinematics.ikKind() != IkKind::numeric) {
        return closedForm(kinematics);
    }
    if (model.axisCount() < for_every_pose) {
        return fmt::format(
            "moves to joint positions can be planned; with {} ax{} hardly any pose can be reached "
            "in position and orientation, so that Cartesian moves are mostly refused",
            model.axisCount(), model.axisCount() == 1 ? "is" : "es");
    }
    return fmt::format(
        "all moves can be planned; inverse kinematics by iteration, since the axes have none of "
        "the structures with a closed form: it finds one solution instead of all, and not always "
        "the nearest{}",
        model.axisCount() == motion::kMaxAxes ? "; there is no arm angle" : "");
}

}  // namespace metier::robot_files
