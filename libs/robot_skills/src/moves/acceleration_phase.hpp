#pragma once

#include "metier/device/arm.hpp"
#include "metier/motion/robot_model.hpp"
#include "metier/motion/trajectory.hpp"

namespace metier::robot_skills {

/// Largest acceleration that the arm may have in a motion of its controller's planner.
///
/// A bound, not a measurement: a controller reports velocities as means over its last cycles, and
/// the driver asks for them once in its own. They are up to 25 ms old with the iiwa, which reaches
/// its full acceleration in that time; their differences are older still, and 0 when a motion
/// begins. So the robot's limits hold from the command until the arm is seen to speed up no more.
/// The acceleration must end at the planned speed at the latest, which makes it less near to it.
///
/// Threading: one thread at a time. Nothing allocates, locks or throws.
class AccelerationPhase {
public:
    /// \param model must outlive it
    /// \param trajectory the plan that the controller may not exceed in speed
    /// \param cycle of the measured states [s]
    AccelerationPhase(const motion::RobotModel& model, motion::Trajectory trajectory, double cycle);

    /// The controller is about to be asked for a motion from rest.
    void restart() noexcept;
    /// Takes a measured state at a place on the path, 0 start to 1 end.
    /// \return acceleration of each axis along the path [rad/s2]; 0 once the arm speeds up no more
    device::JointArray take(const device::ArmState& state, double place) noexcept;

private:
    bool maySpeedUp(const device::ArmState& state) noexcept;

    const motion::RobotModel& model_;
    const motion::Trajectory trajectory_;
    const double cycle_;
    const double top_speed_;  ///< of the path parameter [1/s]
    double reference_ = 0.0;  ///< speed of the fastest axis when it last changed [rad/s]
    double unchanged_ = 0.0;  ///< time since then, while the arm moves [s]
};

}  // namespace metier::robot_skills
