#pragma once

#include <functional>

#include "metier/device/arm.hpp"
#include "metier/motion/trajectory.hpp"
#include "metier/skill/skill.hpp"

namespace metier::robot_skills {

/// Most that any axis may have been moved during a rest for Resume to go on [rad].
inline constexpr double kMovedTolerance = 2e-3;

/// Pose of the tool frame at a joint position, for messages.
using ToolPose = std::function<motion::Pose(const motion::JointVector&)>;

/// Makes that function for the tool frame of `trajectory`.
ToolPose toolPoseOf(const motion::Trajectory& trajectory);

/// An execution that moves an arm by any planner.
class ArmWork : public skill::ExecutionWork {
protected:
    /// \param arm must outlive the work
    ArmWork(device::Arm& arm, ToolPose tool_pose);

    /// From now on a change of the safety state ends the execution if it comes while the arm is not
    /// in motion; during a motion the set-points' source reports it.
    /// \param in_motion called on any thread
    void begin(skill::ExecutionHandle execution, std::function<bool()> in_motion);
    /// Errors: out_of_range with the distance if the arm is no longer where it came to rest.
    Result<void> checkNotMoved(const device::JointArray& rest) const;

    device::Arm& arm() const noexcept { return arm_; }
    const skill::ExecutionHandle& execution() const noexcept { return execution_; }

private:
    device::Arm& arm_;
    ToolPose tool_pose_;
    skill::ExecutionHandle execution_;
    device::Registration safety_watch_;
};

}  // namespace metier::robot_skills
