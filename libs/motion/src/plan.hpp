#pragma once

#include <variant>

#include "braking_bounds.hpp"
#include "metier/motion/kinematics.hpp"
#include "metier/motion/trajectory.hpp"
#include "path.hpp"
#include "speed_map.hpp"

namespace metier::motion {

/// Everything a trajectory is: path, speed along it, and the profile of the clock.
class Trajectory::Plan {
public:
    Plan(const RobotModel& model, std::variant<JointLine, JointPath> path, SpeedPlan speed,
         geometry::Pose flange_from_tool)
        : kinematics_(model.kinematics()),
          path_(std::move(path)),
          braking_(std::visit([&](const auto& of) { return BrakingBounds::of(model, of); }, path_)),
          speed_(std::move(speed)),
          flange_from_tool_(std::move(flange_from_tool)),
          profile_(Profile::toRest({}, speed_.map.end(), speed_.limits)) {}

    /// The same slowed down by `factor` >= 1.
    Plan slowed(double factor) const {
        Plan plan(*this);
        plan.speed_.limits.velocity /= factor;
        plan.speed_.limits.acceleration /= factor * factor;
        plan.speed_.limits.jerk /= factor * factor * factor;
        plan.profile_ = Profile::toRest({}, speed_.map.end(), plan.speed_.limits);
        return plan;
    }

    const Kinematics& kinematics() const noexcept { return kinematics_; }
    const SpeedPlan& speed() const noexcept { return speed_; }
    const BrakingBounds& braking() const noexcept { return braking_; }
    const Profile& profile() const noexcept { return profile_; }
    const geometry::Pose& flangeFromTool() const noexcept { return flange_from_tool_; }
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
    BrakingBounds braking_;
    SpeedPlan speed_;
    geometry::Pose flange_from_tool_;
    Profile profile_;
};

}  // namespace metier::motion
