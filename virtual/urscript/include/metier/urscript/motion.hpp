#pragma once

#include <optional>
#include <variant>

#include "metier/urscript/value.hpp"

namespace metier::urscript {

/// Target of a move: a joint position [rad] or a pose of the tool frame in the base frame.
using Target = std::variant<Vector6, Pose>;

// The motion calls of a script, with the manual's defaults filled in. SI and radians.

/// Lasts `time`.
struct ServoJ {
    Vector6 joint_position{};
    double time = 0.008;          ///< [s]; 0 if the script says 0
    double lookahead_time = 0.1;  ///< [s], 0.03 to 0.2
    double gain = 300.0;          ///< 100 to 2000
};
struct SpeedJ {
    Vector6 velocity{};         ///< [rad/s]
    double acceleration = 0.0;  ///< [rad/s^2] of the leading axis
    double time = 0.0;          ///< [s]; 0: done when the velocity is reached
};
struct SpeedL {
    Vector6 twist{};            ///< base frame, [m/s] and [rad/s]
    double acceleration = 0.0;  ///< [m/s^2]
    double time = 0.0;          ///< [s]; 0: done when the velocity is reached
};
/// Done when the target is reached, or, with a blend radius, when the blend begins.
struct Move {
    Target target{};
    double acceleration =
        0.0;                ///< movej [rad/s^2], else [m/s^2]; optimove: share of the most, 0 to 1
    double velocity = 0.0;  ///< movej [rad/s], else [m/s]; optimove: share of the most, 0 to 1
    double time = 0.0;      ///< [s]; 0: by velocity and acceleration
    double blend_radius = 0.0;  ///< [m]
};
struct MoveJ : Move {};
struct MoveL : Move {};
struct MoveP : Move {};
struct OptimoveJ : Move {};
struct OptimoveL : Move {};
struct MoveC : Move {
    Target via{};
    int mode = 0;  ///< 0 unconstrained orientation, 1 fixed
};
/// Drives the tool towards a target. Lasts one cycle; the arm goes on until it reaches the target
/// or another motion takes over.
struct ServoC {
    Target target{};
    double acceleration = 0.0;  ///< [m/s^2]
    double velocity = 0.0;      ///< [m/s]
    double blend_radius = 0.0;  ///< [m]
};
struct StopJ {
    double acceleration = 2.0;  ///< [rad/s^2]
};
struct StopL {
    double acceleration = 10.0;  ///< [m/s^2]
};
/// Lasts one cycle.
struct DirectTorque {
    Vector6 torque{};  ///< [Nm]
    bool friction_compensation = true;
    std::optional<Vector6> viscous_scale;
    std::optional<Vector6> coulomb_scale;
};

using Motion = std::variant<ServoJ, SpeedJ, SpeedL, MoveJ, MoveL, MoveP, MoveC, OptimoveJ,
                            OptimoveL, ServoC, StopJ, StopL, DirectTorque>;

}  // namespace metier::urscript
