#include "pose_math.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace metier::urscript {
namespace {

Eigen::Vector3d positionOf(const Pose& pose) {
    return {pose.value[0], pose.value[1], pose.value[2]};
}

Eigen::Quaterniond rotationOf(const Eigen::Vector3d& rotation_vector) {
    const double angle = rotation_vector.norm();
    if (!(angle > 0.0)) {
        return Eigen::Quaterniond::Identity();
    }
    return Eigen::Quaterniond(Eigen::AngleAxisd(angle, rotation_vector / angle));
}

Eigen::Quaterniond rotationOf(const Pose& pose) {
    return rotationOf(Eigen::Vector3d(pose.value[3], pose.value[4], pose.value[5]));
}

/// Rotation vector with an angle of at most half a turn.
Eigen::Vector3d vectorOf(const Eigen::Quaterniond& rotation) {
    const Eigen::AngleAxisd turn(rotation.normalized());
    return turn.axis() * turn.angle();
}

Pose poseOf(const Eigen::Vector3d& position, const Eigen::Quaterniond& rotation) {
    const Eigen::Vector3d vector = vectorOf(rotation);
    return {{position.x(), position.y(), position.z(), vector.x(), vector.y(), vector.z()}};
}

}  // namespace

Pose transformed(const Pose& base_from_source, const Pose& source_from_target) {
    const Eigen::Quaterniond rotation = rotationOf(base_from_source);
    return poseOf(positionOf(base_from_source) + rotation * positionOf(source_from_target),
                  rotation * rotationOf(source_from_target));
}

Pose inverted(const Pose& pose) {
    const Eigen::Quaterniond rotation = rotationOf(pose).conjugate();
    return poseOf(-(rotation * positionOf(pose)), rotation);
}

Pose added(const Pose& left, const Pose& right) {
    return poseOf(positionOf(left) + positionOf(right), rotationOf(left) * rotationOf(right));
}

Pose subtracted(const Pose& to, const Pose& from) {
    return poseOf(positionOf(to) - positionOf(from), rotationOf(to) * rotationOf(from).conjugate());
}

Pose interpolated(const Pose& from, const Pose& to, double alpha) {
    const Eigen::Vector3d position = positionOf(from) + alpha * (positionOf(to) - positionOf(from));
    const Eigen::Quaterniond start = rotationOf(from);
    const Eigen::Vector3d turn = vectorOf(start.conjugate() * rotationOf(to));
    return poseOf(position, start * rotationOf(Eigen::Vector3d(alpha * turn)));
}

Vector3 rollPitchYawOf(const Vector3& rotation_vector) {
    const Eigen::Matrix3d matrix =
        rotationOf(Eigen::Vector3d(rotation_vector[0], rotation_vector[1], rotation_vector[2]))
            .toRotationMatrix();
    return {std::atan2(matrix(2, 1), matrix(2, 2)),
            std::atan2(-matrix(2, 0), std::hypot(matrix(0, 0), matrix(1, 0))),
            std::atan2(matrix(1, 0), matrix(0, 0))};
}

Vector3 rotationVectorOf(const Vector3& roll_pitch_yaw) {
    const Eigen::Vector3d vector =
        vectorOf(Eigen::AngleAxisd(roll_pitch_yaw[2], Eigen::Vector3d::UnitZ()) *
                 Eigen::AngleAxisd(roll_pitch_yaw[1], Eigen::Vector3d::UnitY()) *
                 Eigen::AngleAxisd(roll_pitch_yaw[0], Eigen::Vector3d::UnitX()));
    return {vector.x(), vector.y(), vector.z()};
}

}  // namespace metier::urscript
