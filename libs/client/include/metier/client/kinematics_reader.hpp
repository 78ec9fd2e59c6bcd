#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <vector>

#include "metier/client/skill_finder.hpp"
#include "metier/opcua/client.hpp"
#include "metier/opcua_skill/kinematics_data.hpp"

namespace metier::client {

/// Nodes of the Kinematics object of the arm that a skill moves.
struct KinematicsNodes {
    /// BrowseName of the motion device.
    std::string device_name;
    /// Motion device (OPC 40010-1).
    opcua::NodeId device;
    /// Object Kinematics of the motion device.
    opcua::NodeId object;
    /// Measured joint position, Double[n] [rad].
    opcua::NodeId actual_joint_position;
    /// Safety state as a number, opcua_skill::SafetyStateKind.
    opcua::NodeId safety_state;
    /// Number of missed cycles, UInt64.
    opcua::NodeId missed_cycles;
    /// Last set-point, Double[n] [rad]. Null if the server does not have it, as are those below.
    opcua::NodeId commanded_joint_position;
    /// Whether the measured arm does not move, Boolean.
    opcua::NodeId standstill;
    /// Mean deviation of the cycles from their period, Double [s].
    opcua::NodeId cycle_jitter;
    /// Force, Double[3] [N], in the axes of the sensor.
    opcua::NodeId flange_force;
    /// Torque, Double[3] [N m], in the axes of the sensor.
    opcua::NodeId flange_torque;
    /// Measured pose of the flange in the base frame, 3DFrame [m, rad].
    opcua::NodeId actual_pose;
};

/// Finds the nodes of the first motion device with Kinematics, in the nearest object above the
/// skill that has a folder MotionDevices.
/// Errors: not_found, for a skill that moves no published arm, or an arm without
///         ActualJointPosition, SafetyState or MissedCycles; those of the server.
/// Threads: any but the client's own; waits, as do those below.
opcua::Answer<KinematicsNodes> findKinematics(opcua::Client& client, const SkillAddress& skill);

/// Reads the chain, the limits and, if the server publishes it, the payload (0: not known).
/// Errors: not_found, type_mismatch, with the name of what is missing or wrong; invalid_argument if
///         lists have different lengths; those of the server. Values are not checked further:
///         motion::RobotModel::fromChain() does that.
opcua::Answer<opcua_skill::KinematicsData> readKinematics(opcua::Client& client,
                                                          const KinematicsNodes& nodes);

/// Reads the measured joint position [rad], axis 1 first.
/// Errors: type_mismatch; connection_lost, also if the arm's controller is not connected; timeout.
opcua::Answer<std::vector<double>> readJointPosition(opcua::Client& client,
                                                     const KinematicsNodes& nodes);
/// Reads the number of control cycles without a set-point in time, since the arm's server started.
/// Errors: as readJointPosition().
opcua::Answer<std::uint64_t> readMissedCycles(opcua::Client& client, const KinematicsNodes& nodes);

/// Subscribes to the measured joint position [rad], axis 1 first.
/// \param interval sampling interval that the server is asked for; up to 100 values wait in its
///                 queue
/// \param callback runs on the client's thread and must not block; not called for a value that the
///                 server does not have now
/// \return the subscription; the callback is not called after its end
opcua::Answer<opcua::Subscription> subscribeJointPosition(
    opcua::Client& client, const KinematicsNodes& nodes, std::chrono::milliseconds interval,
    std::function<void(const std::vector<double>&)> callback);

}  // namespace metier::client
