#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "metier/motion/joint_vector.hpp"
#include "metier/motion/pose.hpp"

namespace metier::motion {

/// Limits of one axis: lower and upper position [rad]; velocity [rad/s], acceleration [rad/s2] and
/// jerk [rad/s3], all > 0.
struct JointLimits {
    double lower = 0;
    double upper = 0;
    double velocity = 0;
    double acceleration = 0;
    double jerk = 0;
};

/// A revolute joint and its place in the chain.
struct JointDescription {
    std::string name;
    /// Joint frame in the frame of the joint before (of the base for axis 1), at joint position 0.
    Pose parent_from_joint;
    /// Turning axis in the joint frame; a unit vector.
    Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
    JointLimits limits;
};

/// Limits of the tool frame's origin and orientation along a path; all > 0.
struct CartesianLimits {
    double velocity = 0;              ///< [m/s]
    double acceleration = 0;          ///< [m/s2]
    double jerk = 0;                  ///< [m/s3]
    double angular_velocity = 0;      ///< [rad/s]
    double angular_acceleration = 0;  ///< [rad/s2]
    double angular_jerk = 0;          ///< [rad/s3]
};

/// A named frame on the flange, with the mass of the tool for the driver.
struct ToolFrame {
    std::string name;
    Pose flange_from_tool;
    double mass = 0;                                           ///< [kg]
    Eigen::Vector3d centre_of_mass = Eigen::Vector3d::Zero();  ///< in the flange frame [m]
};

/// Description of a robot that a server publishes and a client reads: enough to plan motions.
struct ChainDescription {
    std::vector<JointDescription> joints;  ///< 1 to kMaxAxes
    Pose last_from_flange;                 ///< flange in the last joint's frame
    CartesianLimits cartesian_limits;
    JointVector home;              ///< a usable, non-singular working position [rad]
    std::vector<ToolFrame> tools;  ///< in addition to "flange", which always exists
    double cycle_time = 0.008;     ///< period of the controller [s], > 0
};

}  // namespace metier::motion
