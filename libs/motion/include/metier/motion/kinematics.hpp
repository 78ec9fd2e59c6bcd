#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "metier/base/error.hpp"
#include "metier/motion/pose.hpp"
#include "metier/motion/chain.hpp"
#include "metier/motion/joint_vector.hpp"

namespace metier::motion {

/// Columns: axes. Rows: velocity of the flange origin [m], then of its rotation [1], base frame.
using Jacobian = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, kMaxAxes>;

/// Per axis the range a solution must lie in [rad]. Empty or all zero: not set.
struct AxisBounds {
    JointVector lower;
    JointVector upper;
    bool isSet() const noexcept { return !lower.allZero() || !upper.allZero(); }
};

/// Which of many joint positions is wanted.
struct IkRequest {
    JointVector reference;  ///< the solution nearest to it is chosen [rad]; size axisCount()
    AxisBounds bounds;      ///< besides the joint limits
    /// Arm angle of a 7-axis arm [rad]; without it the reference's own, or the nearest possible.
    std::optional<double> redundancy_angle;
};

/// Joint positions that reach one pose; never allocates.
class JointSolutions {
public:
    static constexpr std::size_t kCapacity = 16;
    void add(const JointVector& solution) noexcept {
        if (size_ < kCapacity) {
            values_[size_++] = solution;
        }
    }
    std::size_t size() const noexcept { return size_; }
    bool empty() const noexcept { return size_ == 0; }
    const JointVector& operator[](std::size_t i) const noexcept { return values_[i]; }
    const JointVector* begin() const noexcept { return values_.data(); }
    const JointVector* end() const noexcept { return values_.data() + size_; }

private:
    std::array<JointVector, kCapacity> values_;
    std::size_t size_ = 0;
};

/// Why a pose is out of reach, whatever the joint limits: something would be `distance` from an
/// axis, and the links allow no more, or no less, than `limit`.
struct ReachMiss {
    std::string_view what = "the flange";
    std::size_t axis = 0;  ///< from 0
    double distance = 0;   ///< [m]
    double limit = 0;      ///< [m]

    bool tooNear() const noexcept { return distance < limit; }
    double excess() const noexcept { return tooNear() ? limit - distance : distance - limit; }
};
/// As "unreachable: the wrist would be 0.9500 m from axis 2, reach 0.8170 m".
std::string toString(const ReachMiss& miss);

/// How a chain's inverse is found; chosen from the chain's structure.
enum class IkKind {
    three_parallel_axes,  ///< axes 2, 3, 4 parallel (UR): up to 8 solutions, closed form
    spherical_wrist,      ///< axes 4, 5, 6 meet, 2 and 3 parallel (e.DO): up to 8, closed form
    arm_angle,            ///< spherical shoulder and wrist (iiwa): up to 8 per arm angle
    numeric,              ///< any other chain: Levenberg-Marquardt, one solution
};
std::string_view toString(IkKind kind) noexcept;

/// A rigid transform as matrix and vector: what the fast paths compute with.
struct Transform {
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
    Eigen::Vector3d translation = Eigen::Vector3d::Zero();
};

/// Axes and points of the chain in the base frame at joint position 0.
struct ZeroPosition {
    std::array<Eigen::Vector3d, kMaxAxes> axis;   ///< unit
    std::array<Eigen::Vector3d, kMaxAxes> point;  ///< one on each axis, chosen by the closed form
    Transform base_from_flange;
    /// Share of a length by which the closed form may miss a pose and still gives a solution, from
    /// which iteration finds that of the calibrated chain; 0 for an exact one.
    double slack = 0;
};

/// Forward and inverse kinematics of one chain.
///
/// Threading: immutable, any thread. Nothing allocates but the text of an error. The same input
/// gives the same bits; budgets are iterations, never time.
///
/// A calibrated UR arm, whose axes are only nearly parallel or meet only nearly (0.02 rad, 10 mm),
/// is solved in the closed form of the nearest exact arm and from there by Levenberg-Marquardt.
/// Source: docs/motion.md#kinematics.
class Kinematics {
public:
    /// \param chain valid as RobotModel checks it
    explicit Kinematics(const ChainDescription& chain);

    std::size_t axisCount() const noexcept { return axis_count_; }
    IkKind ikKind() const noexcept { return kind_; }
    /// Whether the closed form fits nearly only and every solution is refined by iteration.
    bool isCalibrated() const noexcept { return calibrated_; }
    const JointLimits& limits(std::size_t axis) const noexcept { return limits_[axis]; }
    /// Farthest the flange's origin can be from axis 2 [m]: an upper bound.
    double reach() const noexcept { return reach_; }
    /// Why no joint position at all has this pose; nothing if it is in reach, or if that can only
    /// be found by trying.
    /// \param reference as for allSolutions()
    std::optional<ReachMiss> outOfReach(const motion::Pose& base_from_flange,
                                        const JointVector& reference) const noexcept;

    /// base_from_flange. \param q [rad], size axisCount(), finite; limits are not checked
    motion::Pose forward(const JointVector& q) const noexcept;
    /// base_from_joint for every axis (the joint frames of the chain, turned), then the flange.
    std::array<motion::Pose, kMaxAxes + 1> forwardAll(const JointVector& q) const noexcept;
    Jacobian jacobian(const JointVector& q) const noexcept;
    /// Both at the price of one. \param jacobian filled; any content before
    Transform forward(const JointVector& q, Jacobian& jacobian) const noexcept;
    /// Smallest singular value of the Jacobian: 0 in a singularity.
    double smallestSingularValue(const JointVector& q) const;

    /// Every closed-form solution, each axis in (-pi, pi], limits not applied; for a 7-axis arm
    /// those with the arm angle of `reference`, or with `redundancy_angle`; of a numeric chain the
    /// one found from `reference`.
    /// \param reference gives the free axis where the pose leaves one free
    JointSolutions allSolutions(const motion::Pose& base_from_flange,
                                const JointVector& reference) const noexcept;
    JointSolutions allSolutions(const motion::Pose& base_from_flange,
                                const JointVector& reference,
                                double redundancy_angle) const noexcept;

    /// The solution with these axes that follows `guess` without a jump, whole turns included;
    /// empty if there is none. Limits are not applied.
    /// \param guess an extrapolated position [rad]
    JointVector solutionNear(const motion::Pose& base_from_flange, const JointVector& guess,
                             double redundancy_angle) const noexcept;

    /// The solution within limits and bounds nearest to the reference: smallest largest
    /// |difference| / velocity limit over the axes, whole turns included, ties by index.
    /// Errors: unreachable (distance and reach, or the axis, its value and limit),
    ///         invalid_argument (sizes, not finite).
    Result<JointVector> inverse(const motion::Pose& base_from_flange,
                                const IkRequest& request) const;

    /// As inverse(), by Levenberg-Marquardt from the reference and then from fixed other seeds: for
    /// chains without a closed form. The solution found first, not the nearest.
    Result<JointVector> inverseNumerically(const motion::Pose& base_from_flange,
                                           const IkRequest& request) const;

    /// Angle of the elbow about the line from shoulder to wrist, 0 where the elbow is in the plane
    /// through the vertical, upward [rad]; 0 for every chain without an arm angle.
    double redundancyAngle(const JointVector& q) const noexcept;

    /// Levenberg-Marquardt from `seed`, at most `max_iterations`; limits are not applied.
    /// The fallback of inverse() and the means to polish a solution on a calibrated chain.
    std::optional<JointVector> solveNumerically(const motion::Pose& base_from_flange,
                                                const JointVector& seed,
                                                int max_iterations) const noexcept;

    /// Whether each axis is within its limits (1e-9 rad of rounding allowed).
    bool withinLimits(const JointVector& q) const noexcept;

private:
    Result<JointVector> search(const motion::Pose& base_from_flange, const IkRequest& request,
                               IkKind method) const;
    JointSolutions closedForm(const motion::Pose& base_from_flange, const JointVector& reference,
                              double redundancy_angle) const noexcept;
    bool refine(const motion::Pose& base_from_flange, JointVector& solution) const noexcept;
    Eigen::Vector3d reachCentre(const JointVector& q) const noexcept;
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
