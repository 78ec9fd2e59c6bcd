#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "metier/motion/joint_vector.hpp"
#include "metier/motion/pose.hpp"

namespace metier::motion {

/// Limits of one axis. A plan never exceeds them; MotionRun::halt() may, by MotionRun::kHaltFactor.
struct JointLimits {
    /// Lowest position [rad], under `upper`.
    double lower = 0;
    /// Highest position [rad]; more than one turn is allowed.
    double upper = 0;
    /// Largest |velocity| [rad/s], > 0.
    double velocity = 0;
    /// Largest |acceleration| [rad/s2], > 0.
    double acceleration = 0;
    /// Largest |jerk| [rad/s3], > 0.
    double jerk = 0;
};

/// A revolute joint and its place in the chain.
/// Prismatic joints are not supported.
struct JointDescription {
    /// Name for messages, such as "shoulder_pan".
    std::string name;
    /// Joint frame in the frame of the joint before (of the base for axis 1), at joint position 0.
    Pose parent_from_joint;
    /// Turning axis in the joint frame; a unit vector. A positive position turns right-handed about
    /// it.
    Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
    /// Limits of the axis.
    JointLimits limits;
};

/// Limits of the tool frame's origin and orientation along a path; all > 0. A plan never exceeds
/// them.
struct CartesianLimits {
    /// Largest speed of the origin [m/s].
    double velocity = 0;
    /// Largest acceleration of the origin along the path [m/s2].
    double acceleration = 0;
    /// Largest jerk of the origin along the path [m/s3].
    double jerk = 0;
    /// Largest speed of the rotation [rad/s].
    double angular_velocity = 0;
    /// Largest acceleration of the rotation [rad/s2].
    double angular_acceleration = 0;
    /// Largest jerk of the rotation [rad/s3].
    double angular_jerk = 0;
};

/// A named frame on the flange, with the mass of the tool for the driver.
struct ToolFrame {
    /// Name by which requests choose it; not "flange", which always exists.
    std::string name;
    /// Place of the tool frame on the flange.
    Pose flange_from_tool;
    /// Mass of the tool [kg]; 0: not known. Plans do not use it.
    double mass = 0;
    /// Centre of mass of the tool in the flange frame [m].
    Eigen::Vector3d centre_of_mass = Eigen::Vector3d::Zero();
};

/// Description of a robot that a server publishes and a client reads: enough to plan motions.
///
///     base_from_flange = parent_from_joint(1) * turn(1) * ... * turn(n) * last_from_flange
struct ChainDescription {
    /// Joints from the base to the flange, 1 to kMaxAxes.
    std::vector<JointDescription> joints;
    /// Place of the flange in the last joint's frame.
    Pose last_from_flange;
    /// Limits of straight lines and paths, whatever the tool frame is.
    CartesianLimits cartesian_limits;
    /// A usable, non-singular working position within the limits [rad].
    JointVector home;
    /// Tool frames in addition to "flange", which always exists.
    std::vector<ToolFrame> tools;
    /// Period of the controller [s], > 0.
    double cycle_time = 0.008;
};

}  // namespace metier::motion
