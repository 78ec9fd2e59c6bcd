#include "metier/motion/pose.hpp"

namespace metier::motion {

Pose Pose::inverse() const {
    const Eigen::Quaterniond back = rotation.conjugate();
    return {back * -translation, back};
}

Pose operator*(const Pose& a_from_b, const Pose& b_from_c) {
    return {a_from_b.translation + a_from_b.rotation * b_from_c.translation,
            (a_from_b.rotation * b_from_c.rotation).normalized()};
}

Eigen::Vector3d operator*(const Pose& target_from_source, const Eigen::Vector3d& point) {
    return target_from_source.translation + target_from_source.rotation * point;
}

double distanceBetween(const Pose& first, const Pose& second) {
    return (first.translation - second.translation).norm();
}

}  // namespace metier::motion
