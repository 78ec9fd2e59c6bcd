#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace metier::motion {

/// An angle as cosine and sine, so that the closed forms need no trigonometry on the way.
struct AxisRotation {
    double c = 1;
    double s = 0;

    double angle() const noexcept { return std::atan2(s, c); }
    AxisRotation inverse() const noexcept { return {c, -s}; }
    static AxisRotation of(double angle) noexcept { return {std::cos(angle), std::sin(angle)}; }
};

/// The turn by the sum of both angles.
inline AxisRotation operator*(const AxisRotation& a, const AxisRotation& b) noexcept {
    return {a.c * b.c - a.s * b.s, a.s * b.c + a.c * b.s};
}

/// `v` turned about the unit vector `axis`.
inline Eigen::Vector3d rotate(const Eigen::Vector3d& axis, const AxisRotation& turn,
                              const Eigen::Vector3d& v) noexcept {
    return turn.c * v + turn.s * axis.cross(v) + (1 - turn.c) * axis.dot(v) * axis;
}

inline Eigen::Matrix3d rotationMatrix(const Eigen::Vector3d& axis,
                                      const AxisRotation& turn) noexcept {
    const Eigen::Vector3d scaled = (1 - turn.c) * axis;
    Eigen::Matrix3d r = scaled * axis.transpose();
    r.diagonal().array() += turn.c;
    const Eigen::Vector3d sine = turn.s * axis;
    r(0, 1) -= sine.z();
    r(1, 0) += sine.z();
    r(0, 2) += sine.y();
    r(2, 0) -= sine.y();
    r(1, 2) -= sine.x();
    r(2, 1) += sine.x();
    return r;
}

/// Up to two turns that fulfil an equation.
struct AxisRotations {
    std::array<AxisRotation, 2> value;
    std::size_t count = 0;
    /// Set if a double root is so near that rounding shows in the result, which then needs
    /// refining.
    bool delicate = false;
};

/// Below this length a projection is rounding noise and leaves its angle free.
inline constexpr double kFree = 1e-10;

/// The turn about `axis` that brings `from` as near as can be to `to`; `otherwise` where both are
/// along the axis and any turn does.
inline AxisRotation rotationBetween(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                                    const Eigen::Vector3d& axis,
                                    const AxisRotation& otherwise) noexcept {
    const double s = axis.dot(from.cross(to));
    const double c = from.dot(to) - axis.dot(from) * axis.dot(to);
    const double length = std::sqrt(s * s + c * c);
    const double scale = std::sqrt(from.squaredNorm() * to.squaredNorm());
    if (length <= kFree * kFree * scale) {
        return otherwise;
    }
    return {c / length, s / length};
}

/// The points x with normal . x = distance.
struct Plane {
    Eigen::Vector3d normal;
    double distance = 0;
    /// Share of the circle's radius by which a miss still gives two turns, near the touch.
    double slack = 0;
};

/// The turns about `axis` that bring `v` onto the plane. Where any turn does, `otherwise`; a miss
/// by rounding counts as a touch.
inline AxisRotations rotationsOntoPlane(const Plane& plane, const Eigen::Vector3d& v,
                                        const Eigen::Vector3d& axis,
                                        const AxisRotation& otherwise) noexcept {
    const auto& [normal, distance, slack] = plane;
    constexpr double touch = 1e-11;
    constexpr double delicate_share = 1e-6;
    const double along = normal.dot(axis) * axis.dot(v);
    const double a = normal.dot(v) - along;
    const double b = normal.dot(axis.cross(v));
    double c = distance - along;
    const double square = a * a + b * b;
    const double scale = normal.norm() * v.norm();
    AxisRotations turns;
    if (square <= kFree * kFree * scale * scale) {
        turns.count = std::abs(c) <= touch * scale ? 1 : 0;
        turns.value[0] = otherwise;
        turns.delicate = true;
        return turns;
    }
    if (slack > 0) {
        const double most = (1 - slack) * std::sqrt(square);
        c = std::abs(c) < most + 2 * slack * std::sqrt(square) ? std::clamp(c, -most, most) : c;
    }
    const double rest = square - c * c;
    if (rest < -touch * scale * scale) {
        return turns;
    }
    const double root = std::sqrt(std::max(rest, 0.0));
    turns.delicate = rest < delicate_share * square;
    turns.count = rest <= 0 ? 1 : 2;
    const double along_scale = rest <= 0 ? std::copysign(std::sqrt(square), c) : c;
    turns.value[0] = {(a * along_scale - b * root) / square, (b * along_scale + a * root) / square};
    turns.value[1] = {(a * along_scale + b * root) / square, (b * along_scale - a * root) / square};
    return turns;
}

}  // namespace metier::motion
