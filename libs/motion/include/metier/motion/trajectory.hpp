#pragma once

#include <chrono>
#include <cstddef>
#include <memory>

#include "metier/motion/pose.hpp"
#include "metier/motion/joint_vector.hpp"
#include "metier/motion/profile.hpp"

namespace metier::motion {

using Seconds = std::chrono::duration<double>;

/// What the axes shall do at one instant; all three of the same size. Trivially copyable.
struct SetPoint {
    JointVector position;      ///< [rad]
    JointVector velocity;      ///< [rad/s]
    JointVector acceleration;  ///< [rad/s2]
};

/// How far off a path something is.
struct PathDeviation {
    double distance = 0;  ///< of the tool frame's origin from the path [m]
    double angle = 0;     ///< from the orientation that belongs to the nearest path point [rad]
    double fraction = 0;  ///< where on the path, 0 start to 1 end
};

/// A planned motion: a path and the time along it. From rest to rest.
///
/// Threading: immutable, any thread. A copy shares the plan (several threads may hold it: planner,
/// cycle, recorder); drop the last one outside the cycle thread, since that frees memory.
/// Sampling does not allocate, lock or throw, and gives the same bits for the same time.
class Trajectory {
public:
    class Plan;

    explicit Trajectory(std::shared_ptr<const Plan> plan) noexcept : plan_(std::move(plan)) {}

    Seconds duration() const noexcept;
    std::size_t axisCount() const noexcept;
    /// The exact set-point at `time` after the start; before it the first, after the end the last.
    SetPoint sample(Seconds time) const noexcept;
    /// Set-point for a state of the clock along the path (see MotionRun).
    SetPoint sampleAt(const ScalarState& clock) const noexcept;
    /// Path parameter at a clock position, 0 start to 1 end; its derivatives by time.
    ScalarState pathParameter(const ScalarState& clock) const noexcept;
    /// The inverse of pathParameter(): the clock's state for one of the path parameter.
    ScalarState clockAt(const ScalarState& path) const noexcept;
    /// Set-point for a state of the path parameter.
    SetPoint sampleOnPath(const ScalarState& path) const noexcept;
    /// The path parameter's quickest way to rest that the robot's own limits allow, whatever the
    /// motion was planned with.
    /// \param factor part of these limits that may be used, > 0; above 1 for a Halt
    /// \return may end beyond 1 near the end of the path
    Profile brake(const ScalarState& path, double factor) const noexcept;

    JointVector start() const noexcept;
    JointVector end() const noexcept;
    /// Planned joint position at a path parameter in [0, 1].
    JointVector positionAt(double fraction) const noexcept;
    /// Planned base_from_tool at a path parameter in [0, 1].
    motion::Pose poseAt(double fraction) const noexcept;
    motion::Pose endPose() const noexcept { return poseAt(1.0); }
    /// base_from_tool of any joint position, with this motion's tool frame.
    motion::Pose toolPose(const JointVector& q) const noexcept;
    /// How far a pose (a measured one) is from the path. Not for the cycle thread on PTP paths.
    PathDeviation deviation(const motion::Pose& base_from_tool) const noexcept;

    /// Speed of the clock that runs from 0 to clockEnd(), 1 unless the motion was stretched [1].
    double clockSpeed() const noexcept;
    double clockEnd() const noexcept;
    /// The clock's way to rest from `clock`, and that to its end, within the limits of the plan.
    /// \param factor part of these limits that may be used, > 0
    /// \param speed_override share of clockSpeed(), (0, 1]
    Profile brakeClock(const ScalarState& clock, double factor) const noexcept;
    Profile runClock(const ScalarState& clock, double speed_override) const noexcept;
    /// The clock's run as planned.
    const Profile& profile() const noexcept;
    /// Length of the tool frame's path [m] and its turn [rad]; 0 length for PTP.
    double length() const noexcept;
    double angle() const noexcept;

    /// The same motion slowed down to take that long, as for two arms on one clock.
    /// \param duration at least duration(); shorter ones give the motion unchanged
    Trajectory stretchedTo(Seconds duration) const;

private:
    std::shared_ptr<const Plan> plan_;
};

}  // namespace metier::motion
