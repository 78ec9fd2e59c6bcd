#pragma once

#include <string>
#include <vector>

#include "metier/opcua/types.hpp"
#include "metier/opcua_skill/safety_state_kind.hpp"

namespace metier::opcua_skill {

/// Values of the Kinematics object of a motion device that do not change while the server runs.
/// They are enough for a client to compute poses, reach and limits of an arm that it does not know.
/// Lists have one element per axis, axis 1 first.
struct KinematicsData {
    /// Frame of joint 1 in the base frame, at joint position 0 [m, rad].
    opcua::ThreeDFrame base_from_first_joint;
    /// Flange in the frame of the last joint [m, rad].
    opcua::ThreeDFrame last_joint_from_flange;
    /// Each joint in the frame of the joint before, at joint position 0 [m, rad]; the first is the
    /// identity.
    std::vector<opcua::ThreeDFrame> joint_frames;
    /// Turning axes: unit vectors in the joint's frame.
    std::vector<opcua::ThreeDVector> joint_axes;
    /// Lowest joint positions [rad].
    std::vector<double> min_joint_position;
    /// Highest joint positions [rad].
    std::vector<double> max_joint_position;
    /// Largest joint velocities [rad/s].
    std::vector<double> max_joint_velocity;
    /// Largest joint accelerations [rad/s²].
    std::vector<double> max_joint_acceleration;
    /// Largest joint jerks [rad/s³].
    std::vector<double> max_joint_jerk;
    /// Two values for the tool frame: along the path [m/s], rotation [rad/s].
    std::vector<double> max_cartesian_velocity;
    /// Two values for the tool frame: along the path [m/s²], rotation [rad/s²].
    std::vector<double> max_cartesian_acceleration;
    /// Two values for the tool frame: along the path [m/s³], rotation [rad/s³].
    std::vector<double> max_cartesian_jerk;
    /// Period of the controller [s], > 0.
    double cycle_time = 0;
    /// Names that the parameter ToolFrame may have, besides "" for the flange.
    std::vector<std::string> tool_frames;
    /// Greatest mass at the flange [kg], published as OPC 40010-1 FlangeLoad; 0: unknown.
    double payload = 0;

    /// Number of axes, by joint_axes.
    std::size_t axisCount() const noexcept { return joint_axes.size(); }
    friend bool operator==(const KinematicsData&, const KinematicsData&) = default;
};

/// Values of the Kinematics object that change while the arm works.
struct KinematicsState {
    /// Measured joint position [rad], axis 1 first.
    std::vector<double> joint_position;
    /// Measured pose, base_from_flange [m, rad].
    opcua::ThreeDFrame pose;
    /// Safety state that the controller reports.
    SafetyStateKind safety_state = SafetyStateKind::unknown;
    /// Number of cycles without a set-point in time since the server started.
    std::uint64_t missed_cycles = 0;
};

}  // namespace metier::opcua_skill
