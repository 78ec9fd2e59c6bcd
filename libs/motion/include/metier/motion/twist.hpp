#pragma once

#include <Eigen/Core>

namespace metier::motion {

/// Velocity of a frame, expressed in the base frame: that of its origin [m/s] and its angular
/// velocity [rad/s].
struct Twist {
    Eigen::Vector3d linear = Eigen::Vector3d::Zero();
    Eigen::Vector3d angular = Eigen::Vector3d::Zero();
};

/// Force [N] and torque [Nm] on a frame, expressed in that frame.
struct Wrench {
    Eigen::Vector3d force = Eigen::Vector3d::Zero();
    Eigen::Vector3d torque = Eigen::Vector3d::Zero();
};

}  // namespace metier::motion
