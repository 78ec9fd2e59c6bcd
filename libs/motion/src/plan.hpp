#pragma once

#include <variant>

#include "limits_along.hpp"
#include "metier/motion/kinematics.hpp"
#include "metier/motion/trajectory.hpp"
#include "path.hpp"
#include "speed_plan.hpp"

namespace metier::motion {

/// Everything a trajectory is: path, speed along it, and the profile of the clock.
struct Trajectory::Plan {
    Kinematics kinematics;
    std::variant<JointLine, JointPath> path;
    SpeedPlan speed;
    Pose flange_from_tool;
    LimitsAlong braking;  ///< the robot's own limits along the path

    const ToolPath* toolPath() const noexcept {
        const auto* of_tool = std::get_if<JointPath>(&path);
        return of_tool != nullptr ? &of_tool->tool() : nullptr;
    }
    PathPoint pathAt(double s) const noexcept {
        const auto* line = std::get_if<JointLine>(&path);
        return line != nullptr ? line->at(s) : std::get_if<JointPath>(&path)->at(s, kinematics);
    }
};

}  // namespace metier::motion
