#pragma once

#include <Eigen/Core>

namespace metier::motion {

/// Force [N] and torque [Nm] on a frame, expressed in that frame.
struct Wrench {
    Eigen::Vector3d force = Eigen::Vector3d::Zero();
    Eigen::Vector3d torque = Eigen::Vector3d::Zero();
};

}  // namespace metier::motion
