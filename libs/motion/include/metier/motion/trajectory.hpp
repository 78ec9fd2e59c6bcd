#pragma once

#include <chrono>
#include <cstddef>
#include <memory>

#include "metier/motion/joint_vector.hpp"
#include "metier/motion/pose.hpp"
#include "metier/motion/profile.hpp"

namespace metier::motion {

/// Duration or moment in seconds, with fractions.
using Seconds = std::chrono::duration<double>;

/// Target of all axes at one instant; the three vectors have the same size. Trivially copyable.
struct SetPoint {
    /// Joint positions [rad].
    JointVector position;
    /// Joint velocities [rad/s].
    JointVector velocity;
    /// Joint accelerations [rad/s2].
    JointVector acceleration;
};

/// Deviation of a pose from a path.
struct PathDeviation {
    /// Distance of the tool frame's origin from the path [m].
    double distance = 0;
    /// Angle from the orientation at the nearest path point, 0 to pi [rad].
    double angle = 0;
    /// Place of the nearest path point, 0 start to 1 end.
    double fraction = 0;
};

/// A planned motion from rest to rest: a path and the time along it. Made by a Planner, run by a
/// MotionRun.
///
/// Threading: immutable, any thread. A copy shares the plan (several threads may hold it: planner,
/// cycle, recorder); drop the last one outside the cycle thread, since that frees memory. Sampling
/// does not allocate, lock or throw, and gives the same bits for the same time.
class Trajectory {
public:
    /// Content of a plan, known to this library only.
    struct Plan;

    /// \param plan not null; made by a Planner
    explicit Trajectory(std::shared_ptr<const Plan> plan) noexcept : plan_(std::move(plan)) {}

    /// Time from start to end, at the planned speed.
    Seconds duration() const noexcept;
    /// Number of axes of its robot.
    std::size_t axisCount() const noexcept;
    /// The exact set-point at `time` after the start; before the start the first one, after the end
    /// the last one.
    SetPoint sample(Seconds time) const noexcept;
    /// Set-point for a state of the clock along the path (see MotionRun).
    SetPoint sampleAt(const ScalarState& clock) const noexcept;
    /// State of the path parameter (0 start to 1 end, with its time derivatives) at a state of the
    /// clock.
    ScalarState pathParameter(const ScalarState& clock) const noexcept;
    /// The inverse of pathParameter(): the state of the clock for a state of the path parameter.
    ScalarState clockAt(const ScalarState& path) const noexcept;
    /// Set-point for a state of the path parameter.
    SetPoint sampleOnPath(const ScalarState& state) const noexcept;
    /// Quickest way of the path parameter to rest within the robot's own limits, whatever limits
    /// the motion was planned with.
    /// \param factor share of these limits that may be used, > 0; above 1 for a Halt
    /// \return profile of the path parameter; near the end of the path it may end beyond 1
    Profile brake(const ScalarState& path, double factor) const noexcept;

    /// Joint position at the start [rad].
    JointVector start() const noexcept;
    /// Joint position at the end [rad].
    JointVector end() const noexcept;
    /// Planned joint position at a path parameter in [0, 1].
    JointVector positionAt(double fraction) const noexcept;
    /// Planned base_from_tool at a path parameter in [0, 1].
    Pose poseAt(double fraction) const noexcept;
    /// Planned base_from_tool at the end.
    Pose endPose() const noexcept { return poseAt(1.0); }
    /// base_from_tool of any joint position, with this motion's tool frame.
    /// \param q [rad], size axisCount()
    Pose toolPose(const JointVector& q) const noexcept;
    /// Deviation of a pose, for example a measured one, from the path. Not for the cycle thread on
    /// PTP paths.
    PathDeviation deviation(const Pose& base_from_tool) const noexcept;

    /// Speed of the clock that runs from 0 to clockEnd(): 1 unless the motion was stretched, no
    /// unit.
    double clockSpeed() const noexcept;
    /// End of that clock.
    double clockEnd() const noexcept;
    /// Way of the clock from `clock` to rest as soon as possible, within the limits of the plan.
    /// \param factor share of these limits that may be used, > 0
    Profile brakeClock(const ScalarState& clock, double factor) const noexcept;
    /// Way of the clock from `clock` to its end, within the limits of the plan.
    /// \param speed_override share of clockSpeed(), (0, 1]
    Profile runClock(const ScalarState& clock, double speed_override) const noexcept;
    /// Planned run of the clock from start to end.
    const Profile& profile() const noexcept;
    /// Length of the tool frame's path [m]; 0 for a PTP.
    double length() const noexcept;
    /// Rotation of the tool frame along its path [rad]; 0 for a PTP.
    double angle() const noexcept;

    /// The same motion slowed down to the given duration, for example for two arms that arrive
    /// together.
    /// \param duration at least duration(); a shorter one returns the motion unchanged
    Trajectory stretchedTo(Seconds duration) const;

private:
    std::shared_ptr<const Plan> plan_;
};

}  // namespace metier::motion
