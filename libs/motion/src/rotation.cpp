#include "metier/motion/rotation.hpp"

#include <cmath>

namespace metier::motion {

namespace {

/// Closer to 180 degrees than this, the sign of w is rounding noise and must not choose the axis.
constexpr double kHalfTurn = 1e-12;

double firstNonZero(const Eigen::Vector3d& vector) {
    for (const double component : vector) {
        if (std::abs(component) > kHalfTurn) {
            return component;
        }
    }
    return 1.0;
}

/// The one of the two quaternions of a rotation that is the short way round.
Eigen::Quaterniond shortWay(const Eigen::Quaterniond& rotation) {
    const bool half_turn = std::abs(rotation.w()) < kHalfTurn;
    const double sign = half_turn ? firstNonZero(rotation.vec()) : rotation.w();
    return sign < 0 ? Eigen::Quaterniond(-rotation.coeffs()) : rotation;
}

}  // namespace

Eigen::Quaterniond fromRotationVector(const Eigen::Vector3d& vector) {
    const double angle = vector.norm();
    const double half = 0.5 * angle;
    const double scale = angle < 1e-9 ? 0.5 : std::sin(half) / angle;
    Eigen::Quaterniond rotation;
    rotation.w() = std::cos(half);
    rotation.vec() = scale * vector;
    return rotation;
}

Eigen::Vector3d toRotationVector(const Eigen::Quaterniond& rotation) {
    const Eigen::Quaterniond q = shortWay(rotation);
    const double sine = q.vec().norm();
    const double scale = sine < 1e-9 ? 2.0 : 2.0 * std::atan2(sine, q.w()) / sine;
    return scale * q.vec();
}

Eigen::Vector3d rotationVectorBetween(const Eigen::Quaterniond& from,
                                      const Eigen::Quaterniond& to) {
    return toRotationVector(to * from.conjugate());
}

double rotationAngleBetween(const Eigen::Quaterniond& first, const Eigen::Quaterniond& second) {
    return rotationVectorBetween(first, second).norm();
}

Eigen::Quaterniond slerp(const Eigen::Quaterniond& from, const Eigen::Quaterniond& to,
                         double fraction) {
    return fromRotationVector(fraction * rotationVectorBetween(from, to)) * from;
}

}  // namespace metier::motion
