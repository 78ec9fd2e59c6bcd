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
    /// Largest force along x, y, z of the flange frame [N], 0 or more; empty: that direction is not
    /// watched.
    std::array<std::optional<double>, 3> force{};
};

/// Observer of the arm while its controller moves it.
/// One observer may be used for several motions, one after the other.
class MotionObserver {
public:
    virtual ~MotionObserver() = default;
    /// Receives the arm's state in each cycle of the motion. Called by the arm's cycle thread: must
    /// not allocate, lock, wait, log or throw.
    virtual void observe(const ArmState& state) noexcept = 0;
};

/// A motion for the controller's own planner, with the same kinds of paths as metier's planner.
/// A value that is copied by move(); `observer` alone is shared.
struct ControllerPlannedMotion {
    /// Shape of the path.
    enum class Path : std::uint8_t {
        joint,  ///< straight in joint space, to target_flange or else target_joints
        line    ///< the flange along a straight line, to target_flange
    };

    /// Shape of the path, which decides about the kind of target.
    Path path = Path::joint;
    /// Target of a motion to a joint position [rad], axis 1 first; not used with target_flange.
    JointArray target_joints;
    /// base_from_flange [m], [rad]: target of a motion to a pose; needed for a line.
    std::optional<Frame> target_flange{};
    /// Share of the axes' largest velocity, (0, 1].
    double velocity_share = 1.0;
    /// Share of the axes' largest acceleration, (0, 1].
    double acceleration_share = 1.0;
    /// Velocity of the flange along a line [m/s]; 0: the controller's own.
    double line_velocity = 0.0;
    /// Acceleration of the flange along a line [m/s2]; 0: the controller's own.
    double line_acceleration = 0.0;
    /// Contact force at which the motion ends as End::force; none: no force is watched.
    std::optional<ForceCondition> until{};
    /// Called in every cycle until the motion is done; shared, since the arm keeps it until then.
    std::shared_ptr<MotionObserver> observer{};
};

/// Result of such a motion; the arm stands still.
struct MotionOutcome {
    /// Way in which the motion ended.
    enum class End : std::uint8_t {
        at_target,  ///< the target was reached
        stopped,    ///< by stopMotion(), on the path
        force       ///< by ForceCondition, on the path
    };
    /// Way in which the motion ended.
    End end = End::at_target;
    /// Force at the flange when it ended, in the flange frame [N].
    std::array<double, 3> force{};
    /// Torque at the flange when it ended, in the flange frame [N m].
    std::array<double, 3> torque{};
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
    ///         invalid_argument (a target of the wrong size or not finite, a share outside (0, 1],
    ///         a value below 0), out_of_range (a joint target beyond a limit), unreachable (a pose
    ///         out of reach). `done` is not called then.
    virtual Result<void> move(const ControllerPlannedMotion& motion, Done done) = 0;
    /// Brakes on the path; the motion ends as `stopped`. Does nothing if no motion runs.
    /// Does not wait; `done` follows at standstill.
    virtual void stopMotion() noexcept = 0;
};

}  // namespace metier::device
