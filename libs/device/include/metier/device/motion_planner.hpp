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
    /// Largest force along x, y, z of the flange frame [N]; not set: not watched.
    std::array<std::optional<double>, 3> force{};
};

/// Whoever wants to see the arm while its controller moves it.
class MotionObserver {
public:
    virtual ~MotionObserver() = default;
    /// The arm in this cycle of the motion. Called by the arm's cycle thread: must not allocate,
    /// lock, wait, log or throw.
    virtual void observe(const ArmState& state) noexcept = 0;
};

/// A motion for the controller's own planner: the same path kinds as metier plans itself.
struct ControllerPlannedMotion {
    enum class Path : std::uint8_t { joint, line };

    Path path = Path::joint;
    JointArray target_joints;              ///< [rad], for a motion to a joint position
    std::optional<Frame> target_flange{};  ///< base_from_flange, for one to a pose
    /// Parts of what the axes can do, (0, 1].
    double velocity_share = 1.0;
    double acceleration_share = 1.0;
    /// Of the flange along a line [m/s], [m/s2]; 0: the controller's own.
    double line_velocity = 0.0;
    double line_acceleration = 0.0;
    std::optional<ForceCondition> until{};
    /// Told of every cycle until the motion is done; shared, since the arm keeps it so long.
    std::shared_ptr<MotionObserver> observer{};
};

/// How such a motion ended; the arm stands.
struct MotionOutcome {
    enum class End : std::uint8_t { at_target, stopped, force };
    End end = End::at_target;
    std::array<double, 3> force{};   ///< measured at the flange, its axes, when it ended [N]
    std::array<double, 3> torque{};  ///< [Nm]
    /// Largest seen during the motion along x, y, z of the flange, without sign [N].
    std::array<double, 3> largest_force{};
};

/// An arm whose controller plans motions by itself.
///
/// Not together with Arm::attach(): whichever is second gets resource_unavailable.
/// Threading: as Arm.
class MotionPlanner {
public:
    /// Called exactly once for each motion that was accepted, on the arm's notifying thread, at
    /// standstill. Errors: device_fault (the controller refused or stopped the motion, or did not
    /// reach the target; the text has the distance), connection_lost.
    using Done = std::function<void(Result<MotionOutcome>)>;

    virtual ~MotionPlanner() = default;

    /// Begins a motion. Errors: resource_unavailable, device_fault, connection_lost, out_of_range.
    virtual Result<void> move(const ControllerPlannedMotion& motion, Done done) = 0;
    /// Brakes on the path; the motion is done as `stopped`. Nothing happens if none runs.
    virtual void stopMotion() noexcept = 0;
};

}  // namespace metier::device
