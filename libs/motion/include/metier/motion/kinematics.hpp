#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "metier/base/error.hpp"
#include "metier/motion/chain.hpp"
#include "metier/motion/joint_vector.hpp"
#include "metier/motion/pose.hpp"

namespace metier::motion {

/// Jacobian of the flange, in the base frame. A column for each axis; rows: velocity of the flange
/// origin per axis velocity [m/rad], then angular velocity of the flange per axis velocity [1].
using Jacobian = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, kMaxAxes>;

/// Range of each axis for a solution [rad], both ends allowed, in addition to the joint limits.
/// Empty or all zero: not set.
struct AxisBounds {
    /// Lowest and highest position of each axis [rad]; both empty, or both of size axisCount().
    JointVector lower;
    JointVector upper;
    /// Whether any bound is not zero.
    bool isSet() const noexcept { return !lower.allZero() || !upper.allZero(); }
};

/// Choice among the many joint positions that reach a pose.
struct IkRequest {
    /// Position to which the nearest solution is chosen [rad]; size axisCount().
    JointVector reference;
    /// Bounds of the solution in addition to the joint limits.
    AxisBounds bounds;
    /// Arm angle of a 7-axis arm [rad]; without it the arm angle of the reference, or the nearest
    /// possible one.
    std::optional<double> redundancy_angle;
};

/// Joint positions that reach one pose [rad], at most kCapacity; never allocates.
class JointSolutions {
public:
    /// Twice as many as a closed form can find.
    static constexpr std::size_t kCapacity = 16;
    /// Appends a solution; dropped if kCapacity are there.
    void add(const JointVector& solution) noexcept {
        if (size_ < kCapacity) {
            values_[size_++] = solution;
        }
    }
    std::size_t size() const noexcept { return size_; }
    bool empty() const noexcept { return size_ == 0; }
    /// Solution at that place, from 0; `i` must be less than size(), which is not checked.
    const JointVector& operator[](std::size_t i) const noexcept { return values_[i]; }
    const JointVector* begin() const noexcept { return values_.data(); }
    const JointVector* end() const noexcept { return values_.data() + size_; }

private:
    std::array<JointVector, kCapacity> values_;
    std::size_t size_ = 0;
};

/// Reason why a pose is out of reach even without joint limits: the point `what` would be at
/// `distance` from an axis, and the links allow no more, or no less, than `limit`.
struct ReachMiss {
    /// Point of the arm that would be too far or too near: "the wrist".
    std::string_view what = "the flange";
    /// Axis from which the distance counts, from 0; texts count from 1.
    std::size_t axis = 0;
    /// Distance that the pose asks for [m].
    double distance = 0;
    /// Distance that the links allow [m].
    double limit = 0;

    /// Whether the point would be too near, not too far.
    bool tooNear() const noexcept { return distance < limit; }
    /// Distance beyond the limit [m], > 0.
    double excess() const noexcept { return tooNear() ? limit - distance : distance - limit; }
};
/// A text such as "unreachable: the wrist would be 0.9500 m from axis 2, reach 0.8170 m".
std::string toString(const ReachMiss& miss);

/// Method of the inverse kinematics; chosen by the structure of the chain.
enum class IkKind {
    /// Axes 2, 3, 4 parallel (UR): up to 8 solutions, closed form.
    three_parallel_axes,
    /// Axes 4, 5, 6 meet, 2 and 3 parallel (e.DO): up to 8, closed form.
    spherical_wrist,
    /// Spherical shoulder and wrist (iiwa): up to 8 per arm angle, closed form.
    arm_angle,
    /// Any other chain: Levenberg-Marquardt, one solution.
    numeric,
};
/// A rigid transform as matrix and vector, for fast computation. Translation in [m].
struct Transform {
    /// Rotation matrix, target_from_source.
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
    /// Origin of the source frame in the target frame [m].
    Eigen::Vector3d translation = Eigen::Vector3d::Zero();
};

/// Axes and points of the chain in the base frame at joint position 0.
struct ZeroPosition {
    /// Turning axis of each joint, a unit vector.
    std::array<Eigen::Vector3d, kMaxAxes> axis;
    std::array<Eigen::Vector3d, kMaxAxes> point;  ///< a point on each axis, chosen by the closed
                                                  ///< form [m]
    /// Pose of the flange at joint position 0.
    Transform base_from_flange;
    /// Share of a length by which the closed form may miss a pose and still return a solution;
    /// iteration then finds the solution of the calibrated chain from it. 0 for an exact chain.
    double slack = 0;
};

/// Forward and inverse kinematics of one chain:
///
///     const auto& kinematics = model.kinematics();
///     const Pose base_from_flange = kinematics.forward(q);
///     auto back = kinematics.inverse(base_from_flange, {.reference = q});  // q, or why not
///
/// Threading: immutable, any thread. Nothing allocates but the text of an error. The same input
/// gives the same bits: searches are bounded by a number of iterations, never by time.
///
/// For a calibrated UR arm, whose axes are only nearly parallel or only nearly meet (within 0.02
/// rad, 10 mm), the closed form of the nearest exact arm gives a start, from which
/// Levenberg-Marquardt finds the solution.
/// Source: docs/motion.md#kinematics.
class Kinematics {
public:
    /// \param chain valid by the rules of RobotModel::fromChain(); not checked here
    explicit Kinematics(const ChainDescription& chain);

    /// Number of axes of the chain, 1 to kMaxAxes.
    std::size_t axisCount() const noexcept { return axis_count_; }
    /// Method that inverse() uses for this chain.
    IkKind ikKind() const noexcept { return kind_; }
    /// Reports whether the closed form fits only nearly, so that every solution is refined by
    /// iteration.
    bool isCalibrated() const noexcept { return calibrated_; }
    /// Limits of an axis, counted from 0; `axis` must be less than axisCount(), which is not
    /// checked.
    const JointLimits& limits(std::size_t axis) const noexcept { return limits_[axis]; }
    /// Upper bound of the distance of the flange's origin from axis 2 [m]; of a chain of one axis,
    /// from its origin.
    double reach() const noexcept { return reach_; }
    /// Reason why no joint position at all reaches this pose; nothing if it is in reach, or if only
    /// trying can show it.
    /// \param reference as for allSolutions()
    std::optional<ReachMiss> outOfReach(const Pose& base_from_flange,
                                        const JointVector& reference) const noexcept;

    /// Computes base_from_flange.
    /// \param q [rad], size axisCount(), finite; limits are not checked
    Pose forward(const JointVector& q) const noexcept;
    /// Computes base_from_joint for every axis (the turned joint frames of the chain), and after
    /// these base_from_flange, at index axisCount(). Further elements are the identity.
    /// \param q [rad], size axisCount(), finite; limits are not checked
    std::array<Pose, kMaxAxes + 1> forwardAll(const JointVector& q) const noexcept;
    /// Jacobian of the flange at a joint position.
    /// \param q [rad], size axisCount(), finite
    Jacobian jacobian(const JointVector& q) const noexcept;
    /// Computes base_from_flange and the Jacobian together, as fast as one of them.
    /// \param jacobian is overwritten
    Transform forward(const JointVector& q, Jacobian& jacobian) const noexcept;
    /// Smallest singular value of the Jacobian ([m] and [rad] taken together): 0 in a singularity.
    /// Allocates nothing, but takes longer than the functions above.
    double smallestSingularValue(const JointVector& q) const;

    /// Every closed-form solution, each axis in [-pi, pi], limits not applied. For a 7-axis arm:
    /// the solutions with the arm angle of `reference`, or with `redundancy_angle`. For a numeric
    /// chain: the one solution found from `reference`. Empty if the pose is out of reach.
    /// \param reference        gives the value of an axis that the pose leaves free [rad]; size
    ///                         axisCount()
    /// \param redundancy_angle arm angle [rad], finite; not used without an arm angle
    JointSolutions allSolutions(
        const Pose& base_from_flange, const JointVector& reference,
        const std::optional<double>& redundancy_angle = std::nullopt) const noexcept;

    /// The solution that follows `guess` without a jump, whole turns included; empty if there is
    /// none. Limits are not applied.
    /// \param guess            an extrapolated position [rad], size axisCount()
    /// \param redundancy_angle arm angle [rad], finite; not used without an arm angle
    JointVector solutionNear(const Pose& base_from_flange, const JointVector& guess,
                             double redundancy_angle) const noexcept;

    /// The solution within limits and bounds that is nearest to the reference. The distance is the
    /// largest |difference| / velocity limit of all axes, whole turns included; of two equal ones
    /// the first wins. Without a redundancy_angle a 7-axis arm takes the nearest arm angle that has
    /// a solution.
    /// \param base_from_flange finite, with a unit quaternion (1e-6)
    /// Errors: unreachable (distance and reach, or the axis, its value and limit), invalid_argument
    ///         (sizes, not finite).
    Result<JointVector> inverse(const Pose& base_from_flange, const IkRequest& request) const;

    /// Every joint position that inverse() could have chosen, nearest first: each within the limits
    /// and bounds, turned by whole turns to be near the reference. A 7-axis arm without a
    /// redundancy_angle: at that of the reference. For a numeric chain: the nearest.
    /// \param base_from_flange, request as for inverse(); empty if they are not valid
    std::vector<JointVector> inverseAll(const Pose& base_from_flange,
                                        const IkRequest& request) const;

    /// The same by Levenberg-Marquardt, from the reference and then from up to 399 other fixed
    /// seeds: for chains without a closed form. Returns the first solution found, not the nearest.
    /// Errors: as inverse().
    Result<JointVector> inverseNumerically(const Pose& base_from_flange,
                                           const IkRequest& request) const;

    /// Arm angle [rad]: angle of the elbow about the line from shoulder to wrist. It is 0 if the
    /// elbow points upward in the vertical plane through that line, and for every chain without an
    /// arm angle.
    double redundancyAngle(const JointVector& q) const noexcept;

    /// Levenberg-Marquardt from `seed`, with at most `max_iterations`; limits are not applied.
    /// inverse() falls back to it, and uses it to refine solutions of a calibrated chain.
    /// \param seed [rad], size axisCount(), finite
    /// \return a position whose pose is off by less than 1e-9, [m] and [rad] taken together;
    /// nothing if none was found
    std::optional<JointVector> solveNumerically(const Pose& base_from_flange,
                                                const JointVector& seed,
                                                int max_iterations) const noexcept;

    /// Reports whether each axis is within its limits (1e-9 rad of rounding allowed).
    bool withinLimits(const JointVector& q) const noexcept;

private:
    Result<JointVector> search(const Pose& base_from_flange, const IkRequest& request,
                               IkKind method) const;
    JointSolutions closedForm(const Pose& base_from_flange, const JointVector& reference,
                              double redundancy_angle) const noexcept;
    double leastDistanceFromAxis2(const Eigen::Vector3d& point) const noexcept;
    bool polish(const Transform& target, JointVector& solution) const noexcept;

    std::size_t axis_count_ = 0;
    std::array<JointLimits, kMaxAxes> limits_;
    /// Chain with every axis turned to z: the frame of axis i in the frame of the axis before.
    std::array<Transform, kMaxAxes> fixed_;
    Transform last_from_flange_;
    std::array<Eigen::Quaterniond, kMaxAxes> fixed_rotation_;
    Eigen::Quaterniond last_rotation_;
    /// From the z-axis frame of a joint to the joint frame the chain describes.
    std::array<Eigen::Quaterniond, kMaxAxes> axis_from_joint_;
    ZeroPosition zero_;
    IkKind kind_ = IkKind::numeric;
    bool calibrated_ = false;
    double reach_ = 0;
};

}  // namespace metier::motion
