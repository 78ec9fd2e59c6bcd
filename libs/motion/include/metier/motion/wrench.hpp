#pragma once

#include <Eigen/Core>

namespace metier::motion {

/// Force and torque on a frame, expressed in that frame; the name of a variable states which.
struct Wrench {
    /// Force [N].
    Eigen::Vector3d force = Eigen::Vector3d::Zero();
    /// Torque about the frame's origin [N m].
    Eigen::Vector3d torque = Eigen::Vector3d::Zero();
};

}  // namespace metier::motion
