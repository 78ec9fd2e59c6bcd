#pragma once

#include <algorithm>
#include <random>
#include <string>

#include "kdl_urdf.hpp"
#include "metier/motion/robot_model.hpp"
#include "metier/motion/rotation.hpp"

namespace metier::robot_files {

/// Largest differences of two kinematics.
struct PoseDifference {
    double position = 0;  ///< [m]
    double rotation = 0;  ///< [rad]
};

/// A joint position, each axis in +-pi whatever its limits are.
inline motion::JointVector anyPosition(std::size_t axes, std::mt19937_64& random) {
    std::uniform_real_distribution<double> turn(-3.14159, 3.14159);
    motion::JointVector q(axes);
    std::generate(q.begin(), q.end(), [&] { return turn(random); });
    return q;
}

/// The model against KDL's chain of the file from which it was made, over random positions.
inline PoseDifference differenceToKdl(const motion::RobotModel& model, KdlUrdf& kdl, int count) {
    std::mt19937_64 random(1);
    PoseDifference most;
    for (int i = 0; i < count; ++i) {
        const auto q = anyPosition(model.axisCount(), random);
        const auto ours = model.kinematics().forward(q);
        const auto theirs = kdl.forward(q);
        most.position = std::max(most.position, motion::distanceBetween(ours, theirs));
        // Twice the sine of half the angle: exact where the angle is small.
        const Eigen::Quaterniond turn = ours.rotation.conjugate() * theirs.rotation;
        most.rotation = std::max(most.rotation, 2 * turn.vec().norm());
    }
    return most;
}

/// A joint position within the limits, and +-pi.
inline motion::JointVector allowedPosition(const motion::RobotModel& model,
                                           std::mt19937_64& random) {
    motion::JointVector q(model.axisCount());
    for (std::size_t i = 0; i < q.size(); ++i) {
        const auto& limits = model.limits(i);
        std::uniform_real_distribution<double> range(std::max(limits.lower, -3.14159),
                                                     std::min(limits.upper, 3.14159));
        q[i] = range(random);
    }
    return q;
}

}  // namespace metier::robot_files
