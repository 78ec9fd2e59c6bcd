#pragma once

#include "metier/motion/chain.hpp"
#include "metier/motion/profile.hpp"

namespace metier::motion {

/// Limits of an axis that follows.
struct FollowerLimits : JointLimits {
    double deceleration = 0;  ///< while it brakes [rad/s2], >= acceleration
};

/// The quickest stop of an axis whose state is in finite differences, with its acceleration limit.
Profile brakeProfile(const ScalarState& now, const JointLimits& limits, double cycle) noexcept;

/// The softest stop that takes no longer than `duration` [s], which the quickest one must not. Axes
/// that brake in one time so stay on the straight line on which they move.
Profile brakeWithin(double duration, const ScalarState& now, const JointLimits& limits,
                    double cycle) noexcept;

/// A moving target in finite differences: where it is at the axis' own time, and a cycle later.
struct TargetStates {
    ScalarState before;
    ScalarState now;
    /// An error that could fade with a slower root only is steered away instead: with a noisy
    /// target a slow root makes much of small errors of velocity and acceleration.
    double slowest_decay = 0.95;
};

/// One cycle of an axis that follows a moving target and breaks no limit.
///
/// The motion is a sequence of positions; velocity, acceleration and jerk are their finite
/// differences, since these are what a controller sees. The target is taken as it is if the limits
/// allow; else the error fades out as fast as they allow, and from farther away the axis, seen from
/// the target, steers to where it can just brake to stand on it.
/// \param now     position of the last cycle
/// \param targets of the last cycle and of this one
/// \param cycle   [s]
ScalarState followTarget(const ScalarState& now, const TargetStates& target,
                         const FollowerLimits& limits, double cycle) noexcept;

/// One cycle towards `position` [rad], as near as the limits allow; exactly there if they do.
ScalarState stepTo(double position, const ScalarState& now, const FollowerLimits& limits,
                   double cycle) noexcept;

}  // namespace metier::motion
