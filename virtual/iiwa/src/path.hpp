#pragma once

#include <memory>
#include <optional>

#include "metier/base/error.hpp"
#include "metier/motion/pose.hpp"
#include "metier/motion/profile.hpp"
#include "metier/motion/robot_model.hpp"

namespace metier::virtual_iiwa {

/// Limits that the PC sets for a motion; the defaults are those of the robot application.
struct MotionLimits {
    double joint_velocity = 1.0;      ///< share of what the axes can
    double joint_acceleration = 1.0;  ///< share of what the axes can
    double joint_jerk = 1.0;          ///< share of what the axes can
    double velocity = 1.0;            ///< velocity of the tool frame [m/s]
    double acceleration = 1.0;        ///< [m/s2]
    double jerk = 1.0;                ///< [m/s3]; the cabinet takes no notice of it
};

/// Limits of the drives of one axis with these shares: [rad/s], [rad/s2], [rad/s3].
motion::ScalarLimits axisLimits(const motion::RobotModel& model, std::size_t axis,
                                const MotionLimits& limits);

/// Joint positions along a motion, by a parameter from 0 to 1.
class Path {
public:
    virtual ~Path() = default;
    /// Joint position [rad]; nothing where the arm cannot be.
    /// \param near the last position
    virtual std::optional<motion::JointVector> at(double parameter,
                                                  const motion::JointVector& near) const = 0;

    motion::ScalarLimits limits;  ///< limits of the parameter
};

/// Moving frame: a tool frame on the flange, or the flange itself.
struct MovingFrame {
    const motion::RobotModel* model = nullptr;
    motion::Pose flange_from_tool;
};

using Planned = Result<std::unique_ptr<Path>>;

/// All axes start and end together.
/// Errors: out_of_range (outside of the joint limits), invalid_argument (no speed).
Planned planPtp(const motion::RobotModel& model, const motion::JointVector& start,
                const motion::JointVector& target, const MotionLimits& limits);
/// The same to a pose, with the joint position nearest to the start.
Planned planPtp(const MovingFrame& frame, const motion::JointVector& start,
                const motion::Pose& base_from_tool, const MotionLimits& limits);
/// Along a straight line while the orientation turns the short way; slower where an axis needs it.
/// Errors: unreachable on the way, invalid_argument.
Planned planLinear(const MovingFrame& frame, const motion::JointVector& start,
                   const motion::Pose& base_from_tool, const MotionLimits& limits);

struct CirclePoints {
    Eigen::Vector3d auxiliary;  ///< [m]
    Eigen::Vector3d end;        ///< [m]
};
/// Along the circle through three points; the orientation stays.
/// Errors: as planLinear(); invalid_argument if the points are on a line.
Planned planCircle(const MovingFrame& frame, const motion::JointVector& start,
                   const CirclePoints& points, const MotionLimits& limits);

}  // namespace metier::virtual_iiwa
