#pragma once

#include <variant>

#include "limits_along.hpp"
#include "metier/motion/kinematics.hpp"
#include "metier/motion/trajectory.hpp"
#include "path.hpp"
#include "speed_plan.hpp"

namespace metier::motion {

/// Everything a trajectory is: path, speed along it, and the profile of the clock.
class Trajectory::Plan {
public:
    Plan(const RobotModel& model, std::variant<JointLine, JointPath> path, SpeedPlan speed,
         motion::Pose flange_from_tool)
        : kinematics_(model.kinematics()),
          path_(std::move(path)),
          braking_(
              std::visit([&](const auto& of) { return LimitsAlong::ofRobot(model, of); }, path_)),
          speed_(std::move(speed)),
          flange_from_tool_(std::move(flange_from_tool)) {}

    /// The same slowed down by `factor` >= 1.
    Plan slowed(double factor) const {
        Plan plan(*this);
        plan.speed_ = speed_.slowed(factor);
        return plan;
    }

    const Kinematics& kinematics() const noexcept { return kinematics_; }
    const SpeedPlan& speed() const noexcept { return speed_; }
    const LimitsAlong& braking() const noexcept { return braking_; }
    const motion::Pose& flangeFromTool() const noexcept { return flange_from_tool_; }
    const ToolPath* toolPath() const noexcept {
        const auto* path = std::get_if<JointPath>(&path_);
        return path != nullptr ? &path->tool() : nullptr;
    }
    PathPoint pathAt(double s) const noexcept {
        const auto* line = std::get_if<JointLine>(&path_);
        return line != nullptr ? line->at(s) : std::get_if<JointPath>(&path_)->at(s, kinematics_);
    }

private:
    Kinematics kinematics_;
    std::variant<JointLine, JointPath> path_;
    LimitsAlong braking_;
    SpeedPlan speed_;
    motion::Pose flange_from_tool_;
};

}  // namespace metier::motion
