#pragma once

#include <cstddef>
#include <vector>

#include "metier/motion/kinematics.hpp"
#include "metier/motion/pose.hpp"
#include "tool_path.hpp"

namespace metier::motion {

/// Joint position along a path and its first two derivatives by the path parameter.
struct PathPoint {
    JointVector q;
    JointVector first;
    JointVector second;
};

/// Straight in joint space; path parameter 0 to 1.
struct JointLine {
    JointVector from;
    JointVector delta;

    PathPoint at(double s) const noexcept;
};

/// Path of the flange: that of a tool frame on it and, for an arm that has one, its arm angle.
struct FlangePath {
    ToolPath tool;
    Pose tool_from_flange;
    double arm_angle = 0;       ///< arm angle at the start [rad]
    double arm_angle_turn = 0;  ///< change of the arm angle from start to end [rad]

    Pose at(double s) const noexcept { return tool.at(s) * tool_from_flange; }
    double armAngleAt(double s) const noexcept { return arm_angle + s * arm_angle_turn; }
};

/// Derivatives of the joint position by the path parameter.
struct JointDerivatives {
    JointVector first;
    JointVector second;
    JointVector third;
};

/// Joint positions of a Cartesian path at places of the path parameter, free of jumps; between them
/// exact inverse kinematics, guided by interpolation.
///
/// Where a path passes close by a singularity, the exact positions turn an axis by up to half a
/// turn and back between two knots that show nothing of it. There the path follows the
/// interpolation, which leads through the singularity, as far off the path as the path is off the
/// singularity.
class JointPath {
public:
    JointPath() = default;
    /// \param places path parameters of the knots, rising from 0 to 1; at least five
    JointPath(FlangePath flange, std::vector<double> places, std::vector<JointVector> knots,
              const Kinematics& kinematics);

    const ToolPath& tool() const noexcept { return flange_.tool; }
    const std::vector<double>& places() const noexcept { return places_; }
    const std::vector<JointVector>& knots() const noexcept { return knots_; }
    /// Derivatives at the knots.
    const std::vector<JointDerivatives>& derivatives() const noexcept { return derivatives_; }
    /// Whether positions from that knot to the next one are interpolated, so that the tool leaves
    /// its path a little.
    bool leavesToolPath(std::size_t knot) const noexcept { return interpolated_[knot] != 0; }
    /// Exact position, but beside a singularity; derivatives interpolated.
    PathPoint at(double s, const Kinematics& kinematics) const noexcept;

private:
    /// Number of the interval in which `s` lies; it begins at the knot of that number.
    std::size_t intervalOf(double s) const noexcept;
    PathPoint interpolate(std::size_t interval, double s) const noexcept;
    JointVector exactNear(const JointVector& guess, double s,
                          const Kinematics& kinematics) const noexcept;
    /// Whether a singularity is passed in the interval at which exact inverse kinematics leaves the
    /// interpolation.
    bool passesSingularity(std::size_t interval, const Kinematics& kinematics) const noexcept;
    /// Marks an interval, and those around it up to knots at which exact inverse kinematics and
    /// interpolation have the same speed.
    void interpolateAround(std::size_t interval, const Kinematics& kinematics) noexcept;
    /// Place in the interval at which that singularity measure (path.cpp) passes 0.
    double crossingOf(std::size_t measure, std::size_t interval,
                      const Kinematics& kinematics) const noexcept;

    FlangePath flange_;
    std::vector<double> places_;
    std::vector<JointVector> knots_;
    std::vector<JointDerivatives> derivatives_;
    std::vector<char> interpolated_;  // by interval: whether its positions are interpolated
};

}  // namespace metier::motion
