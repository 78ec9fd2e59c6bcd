#pragma once

#include <optional>
#include <variant>

#include "metier/urscript/value.hpp"

namespace metier::urscript {

/// Target of a move: a joint position [rad] or a pose of the tool frame in the base frame.
using Target = std::variant<Vector6, Pose>;

// The motion calls of a script, with the manual's defaults filled in. SI and radians. Source:
// URScript manual.

/// `servoj`: follows a joint position. Lasts `time`.
struct ServoJ {
    /// Joint position, axis 1 first [rad].
    Vector6 joint_position{};
    /// Time for which it lasts [s]; 0 if the script says 0.
    double time = 0.008;
    /// Time by which the motion is smoothed [s], 0.03 to 0.2.
    double lookahead_time = 0.1;
    /// Gain of following, 100 to 2000.
    double gain = 300.0;
};
/// `speedj`: moves with a joint velocity.
struct SpeedJ {
    /// Joint velocity, axis 1 first [rad/s].
    Vector6 velocity{};
    /// Acceleration of the leading axis [rad/s^2].
    double acceleration = 0.0;
    /// Time for which it lasts [s]; 0: done when the velocity is reached.
    double time = 0.0;
};
/// `speedl`: moves with a twist of the tool.
struct SpeedL {
    /// Twist in the base frame, [m/s] and [rad/s].
    Vector6 twist{};
    /// Acceleration of the tool [m/s^2].
    double acceleration = 0.0;
    /// Time for which it lasts [s]; 0: done when the velocity is reached.
    double time = 0.0;
};
/// Common part of the moves to a target. Done when the target is reached, or, with a blend radius,
/// when the blend begins.
struct Move {
    /// Target of the move.
    Target target{};
    /// Acceleration: movej of the leading axis [rad/s^2], else of the tool [m/s^2]; optimovej and
    /// optimovel: share of the most, 0 to 1.
    double acceleration = 0.0;
    /// Velocity: movej of the leading axis [rad/s], else of the tool [m/s]; optimovej and
    /// optimovel: share of the most, 0 to 1.
    double velocity = 0.0;
    /// Duration [s]; 0: by velocity and acceleration.
    double time = 0.0;
    /// Radius of the blend into the next move [m]; 0: stops at the target.
    double blend_radius = 0.0;
};
/// `movej`: straight in joint space.
struct MoveJ : Move {};
/// `movel`: the tool along a straight line.
struct MoveL : Move {};
/// `movep`: a straight line with constant speed.
struct MoveP : Move {};
/// `optimovej`: as movej, with shares of the limits.
struct OptimoveJ : Move {};
/// `optimovel`: as movel, with shares of the limits.
struct OptimoveL : Move {};
/// `movec`: the tool along an arc.
/// The arc leads from the present place of the tool through `via` to the target.
struct MoveC : Move {
    /// A place on the arc.
    Target via{};
    /// Orientation on the way: 0 unconstrained, 1 fixed.
    int mode = 0;
};
/// `servoc`: drives the tool towards a target. Lasts one cycle; the arm goes on until it reaches
/// the target or another motion takes over.
struct ServoC {
    /// Target of the tool.
    Target target{};
    /// Acceleration of the tool [m/s^2].
    double acceleration = 0.0;
    /// Velocity of the tool [m/s].
    double velocity = 0.0;
    /// Radius of the blend into the next target [m].
    double blend_radius = 0.0;
};
/// `stopj`: brakes in joint space.
struct StopJ {
    /// Deceleration of the leading axis [rad/s^2].
    double acceleration = 2.0;
};
/// `stopl`: brakes the tool on its line.
struct StopL {
    /// Deceleration of the tool [m/s^2].
    double acceleration = 10.0;
};
/// `direct_torque`: commands the joints' torques. Lasts one cycle.
struct DirectTorque {
    /// Torque of each joint, axis 1 first [N m].
    Vector6 torque{};
    /// Whether the controller compensates friction.
    bool friction_compensation = true;
    /// Factors of that compensation for each joint; absent: the controller's own.
    std::optional<Vector6> viscous_scale;
    std::optional<Vector6> coulomb_scale;
};

/// Any of these.
using Motion = std::variant<ServoJ, SpeedJ, SpeedL, MoveJ, MoveL, MoveP, MoveC, OptimoveJ,
                            OptimoveL, ServoC, StopJ, StopL, DirectTorque>;

}  // namespace metier::urscript
