#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

#include "metier/base/quantities.hpp"
#include "metier/device/arm.hpp"

namespace metier::device {

/// A contact force that ends a motion.
struct ForceCondition {
    /// Largest force along x, y, z of the flange frame [N]; empty: that direction is not watched.
    std::array<std::optional<double>, 3> force{};
};

/// Observer of the arm while its controller moves it.
class MotionObserver {
public:
    virtual ~MotionObserver() = default;
    /// Receives the arm's state in each cycle of the motion. Called by the arm's cycle thread: must
    /// not allocate, lock, wait, log or throw.
    virtual void observe(const ArmState& state) noexcept = 0;
};

/// A motion for the controller's own planner, with the same kinds of paths as metier's planner.
struct ControllerPlannedMotion {
    enum class Path : std::uint8_t { joint, line };

    Path path = Path::joint;
    JointArray target_joints;              ///< target of a motion to a joint position [rad]
    std::optional<Frame> target_flange{};  ///< base_from_flange, target of a motion to a pose
    /// Share of the axes' largest velocity and acceleration, (0, 1].
    double velocity_share = 1.0;
    double acceleration_share = 1.0;
    /// Velocity [m/s] and acceleration [m/s2] of the flange along a line; 0: the controller's own.
    double line_velocity = 0.0;
    double line_acceleration = 0.0;
    std::optional<ForceCondition> until{};
    /// Called in every cycle until the motion is done; shared, since the arm keeps it until then.
    std::shared_ptr<MotionObserver> observer{};
};

/// Result of such a motion; the arm stands still.
struct MotionOutcome {
    enum class End : std::uint8_t { at_target, stopped, force };
    End end = End::at_target;
    std::array<double, 3> force{};   ///< at the flange when it ended, in the flange frame [N]
    std::array<double, 3> torque{};  ///< at the flange when it ended, in the flange frame [Nm]
    /// Largest absolute force during the motion along x, y, z of the flange frame [N].
    std::array<double, 3> largest_force{};
};

/// An arm whose controller plans motions by itself.
///
/// Cannot be used together with Arm::attach(): the second of the two gets resource_unavailable.
/// Threading: as Arm.
class MotionPlanner {
public:
    /// Called exactly once for each motion that was accepted, on the arm's notifying thread, at
    /// standstill. Errors: device_fault (the controller refused or stopped the motion, or did not
    /// reach the target; the text has the distance), connection_lost.
    using Done = std::function<void(Result<MotionOutcome>)>;

    virtual ~MotionPlanner() = default;

    /// Begins a motion; does not wait for it.
    /// Errors: resource_unavailable (another motion runs), device_fault, connection_lost,
    /// out_of_range.
    virtual Result<void> move(const ControllerPlannedMotion& motion, Done done) = 0;
    /// Brakes on the path; the motion ends as `stopped`. Does nothing if no motion runs.
    virtual void stopMotion() noexcept = 0;
};

}  // namespace metier::device
