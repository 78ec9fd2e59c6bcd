#include "metier/motion/kinematics.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "axis_rotation.hpp"
#include "closed_form.hpp"

namespace metier::motion {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Turned about z, then put into the frame.
void turn(Transform& frame, const Matrix3d& turned, double q) noexcept {
    const double c = std::cos(q);
    const double s = std::sin(q);
    frame.rotation.col(0) = c * turned.col(0) + s * turned.col(1);
    frame.rotation.col(1) = c * turned.col(1) - s * turned.col(0);
    frame.rotation.col(2) = turned.col(2);
}

/// The first axis of a chain: fixed, then turned about its z.
Transform begin(const Transform& fixed, double q) noexcept {
    Transform frame;
    frame.translation = fixed.translation;
    turn(frame, fixed.rotation, q);
    return frame;
}

/// frame * fixed, then turned about the new z.
void advance(Transform& frame, const Transform& fixed, double q) noexcept {
    frame.translation += frame.rotation * fixed.translation;
    const Matrix3d turned = frame.rotation * fixed.rotation;
    turn(frame, turned, q);
}

/// rotation * (a turn about z)
Eigen::Quaterniond turnedAboutZ(const Eigen::Quaterniond& rotation, double q) noexcept {
    const double c = std::cos(0.5 * q);
    const double s = std::sin(0.5 * q);
    return {rotation.w() * c - rotation.z() * s, rotation.x() * c + rotation.y() * s,
            rotation.y() * c - rotation.x() * s, rotation.z() * c + rotation.w() * s};
}

/// Length of the links from axis 2 to the flange, by points on the axes.
double reachOf(const ZeroPosition& zero) {
    double length = (zero.base_from_flange.translation - zero.point[5]).norm();
    for (std::size_t i = 1; i < 5; ++i) {
        length += (zero.point[i + 1] - zero.point[i]).norm();
    }
    return length;
}

Transform compose(const Transform& a, const Transform& b) noexcept {
    return {a.rotation * b.rotation, a.translation + a.rotation * b.translation};
}

Pose poseOf(const Transform& transform) noexcept {
    return {transform.translation, Eigen::Quaterniond(transform.rotation)};
}

}  // namespace

std::string toString(const ReachMiss& miss) {
    return fmt::format("unreachable: {} would be {:.4f} m from axis {}, {} {:.4f} m", miss.what,
                       miss.distance, miss.axis + 1, miss.tooNear() ? "at least" : "reach",
                       miss.limit);
}

Kinematics::Kinematics(const ChainDescription& chain) : axis_count_(chain.joints.size()) {
    fixed_rotation_.fill(Eigen::Quaterniond::Identity());
    Matrix3d from_axis = Matrix3d::Identity();  // joint_from_z_axis_frame of the joint before
    Transform zero;
    for (std::size_t i = 0; i < axis_count_; ++i) {
        const JointDescription& joint = chain.joints[i];
        limits_[i] = joint.limits;
        const Matrix3d to_axis =
            Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), joint.axis).toRotationMatrix();
        fixed_[i].rotation =
            from_axis.transpose() * joint.parent_from_joint.rotation.toRotationMatrix() * to_axis;
        fixed_[i].translation = from_axis.transpose() * joint.parent_from_joint.translation;
        fixed_rotation_[i] = Eigen::Quaterniond(fixed_[i].rotation);
        axis_from_joint_[i] = Eigen::Quaterniond(Matrix3d(to_axis.transpose()));
        from_axis = to_axis;
        zero = compose(zero, fixed_[i]);
        zero_.axis[i] = zero.rotation.col(2);
        zero_.point[i] = zero.translation;
        reach_ += i > 1 ? fixed_[i].translation.norm() : 0.0;
    }
    last_from_flange_.rotation =
        from_axis.transpose() * chain.last_from_flange.rotation.toRotationMatrix();
    last_from_flange_.translation = from_axis.transpose() * chain.last_from_flange.translation;
    last_rotation_ = Eigen::Quaterniond(last_from_flange_.rotation);
    reach_ += last_from_flange_.translation.norm();
    zero_.base_from_flange = compose(zero, last_from_flange_);
    kind_ = recogniseStructure(axis_count_, zero_);
    if (kind_ == IkKind::numeric && axis_count_ == 6 && idealise(zero_)) {
        kind_ = IkKind::three_parallel_axes;
        calibrated_ = true;
        reach_ = reachOf(zero_);
    }
}

double Kinematics::leastDistanceFromAxis2(const Vector3d& point) const noexcept {
    const Vector3d from_first = point - zero_.point[0];
    if (axis_count_ < 2) {
        return from_first.norm();
    }
    // Axis 1 carries the origin of axis 2 round a circle.
    const Vector3d& axis = zero_.axis[0];
    const Vector3d second = zero_.point[1] - zero_.point[0];
    return std::hypot(axis.dot(from_first - second),
                      axis.cross(from_first).norm() - axis.cross(second).norm());
}

Pose Kinematics::forward(const JointVector& q) const noexcept {
    // Quaternions need fewer products than matrices here, and the pose wants one.
    Pose pose{fixed_[0].translation, turnedAboutZ(fixed_rotation_[0], q[0])};
    for (std::size_t i = 1; i < axis_count_; ++i) {
        pose.translation += pose.rotation * fixed_[i].translation;
        pose.rotation = turnedAboutZ(pose.rotation * fixed_rotation_[i], q[i]);
    }
    pose.translation += pose.rotation * last_from_flange_.translation;
    pose.rotation = pose.rotation * last_rotation_;
    return pose;
}

std::array<Pose, kMaxAxes + 1> Kinematics::forwardAll(const JointVector& q) const noexcept {
    std::array<Pose, kMaxAxes + 1> poses;
    Transform frame;
    for (std::size_t i = 0; i < axis_count_; ++i) {
        advance(frame, fixed_[i], q[i]);
        poses[i] = poseOf(frame);
        poses[i].rotation = poses[i].rotation * axis_from_joint_[i];
    }
    poses[axis_count_] = poseOf(compose(frame, last_from_flange_));
    return poses;
}

Transform Kinematics::forward(const JointVector& q, Jacobian& jacobian) const noexcept {
    jacobian.resize(6, static_cast<Eigen::Index>(axis_count_));
    std::array<Vector3d, kMaxAxes> origin;
    Transform frame = begin(fixed_[0], q[0]);
    for (std::size_t i = 0; i < axis_count_; ++i) {
        if (i > 0) {
            advance(frame, fixed_[i], q[i]);
        }
        jacobian.col(static_cast<Eigen::Index>(i)).tail<3>() = frame.rotation.col(2);
        origin[i] = frame.translation;
    }
    Transform end = compose(frame, last_from_flange_);
    for (std::size_t i = 0; i < axis_count_; ++i) {
        auto column = jacobian.col(static_cast<Eigen::Index>(i));
        column.head<3>() = column.tail<3>().cross(end.translation - origin[i]);
    }
    return end;
}

Jacobian Kinematics::jacobian(const JointVector& q) const noexcept {
    Jacobian result;
    forward(q, result);
    return result;
}

double Kinematics::smallestSingularValue(const JointVector& q) const {
    const Eigen::JacobiSVD<Jacobian> svd(jacobian(q));
    return svd.singularValues().minCoeff();
}

double Kinematics::redundancyAngle(const JointVector& q) const noexcept {
    if (kind_ != IkKind::arm_angle) {
        return 0.0;
    }
    // Elbow and axis 4 at q, from the zero position turned by axes 1 to 3.
    const auto& axis = zero_.axis;
    const Matrix3d shoulder = rotationMatrix(axis[0], AxisRotation::of(q[0])) *
                              rotationMatrix(axis[1], AxisRotation::of(q[1])) *
                              rotationMatrix(axis[2], AxisRotation::of(q[2]));
    const Vector3d upper = zero_.point[3] - zero_.point[0];
    const Vector3d line =
        upper + rotate(axis[3], AxisRotation::of(q[3]), zero_.point[4] - zero_.point[3]);
    const Vector3d normal = axis[3].cross(line);
    const ArmPlane plane = armPlane(shoulder * line);
    const Vector3d elbow = shoulder * (upper.dot(normal) < 0 ? Vector3d(-normal) : normal);
    return std::atan2(elbow.dot(plane.side), elbow.dot(plane.up));
}

bool Kinematics::withinLimits(const JointVector& q) const noexcept {
    constexpr double rounding = 1e-9;
    for (std::size_t i = 0; i < axis_count_; ++i) {
        if (q[i] < limits_[i].lower - rounding || q[i] > limits_[i].upper + rounding) {
            return false;
        }
    }
    return true;
}

}  // namespace metier::motion
