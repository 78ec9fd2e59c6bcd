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
    opcua::ThreeDFrame base_from_first_joint;      ///< at joint position 0 [m, rad]
    opcua::ThreeDFrame last_joint_from_flange;     ///< [m, rad]
    std::vector<opcua::ThreeDFrame> joint_frames;  ///< joint in the frame of the joint before, at
                                                   ///< joint position 0; the first is the identity
    std::vector<opcua::ThreeDVector> joint_axes;   ///< unit vectors in the joint's frame
    std::vector<double> min_joint_position;        ///< [rad]
    std::vector<double> max_joint_position;        ///< [rad]
    std::vector<double> max_joint_velocity;        ///< [rad/s]
    std::vector<double> max_joint_acceleration;    ///< [rad/s²]
    std::vector<double> max_joint_jerk;            ///< [rad/s³]
    std::vector<double> max_cartesian_velocity;    ///< [m/s], [rad/s]
    std::vector<double> max_cartesian_acceleration;  ///< [m/s²], [rad/s²]
    std::vector<double> max_cartesian_jerk;          ///< [m/s³], [rad/s³]
    double cycle_time = 0;                           ///< period of the controller [s]
    /// Names that the parameter ToolFrame may have
    std::vector<std::string> tool_frames;
    /// Greatest mass at the flange [kg], published as OPC 40010-1 FlangeLoad; 0: unknown.
    double payload = 0;

    std::size_t axisCount() const noexcept { return joint_axes.size(); }
    friend bool operator==(const KinematicsData&, const KinematicsData&) = default;
};

/// Values of the Kinematics object that change while the arm works.
struct KinematicsState {
    std::vector<double> joint_position;  ///< measured [rad]
    opcua::ThreeDFrame pose;             ///< measured, base_from_flange [m, rad]
    SafetyStateKind safety_state = SafetyStateKind::unknown;
    std::uint64_t missed_cycles = 0;  ///< since the server started
};

}  // namespace metier::opcua_skill
