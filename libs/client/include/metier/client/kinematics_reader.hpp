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
    std::string device_name;  ///< BrowseName of the motion device
    opcua::NodeId device;     ///< the motion device
    opcua::NodeId object;     ///< its object Kinematics
    opcua::NodeId actual_joint_position;
    opcua::NodeId safety_state;
    opcua::NodeId missed_cycles;
    opcua::NodeId commanded_joint_position;  ///< null if the server does not have it; as the next
    opcua::NodeId standstill;
    opcua::NodeId cycle_jitter;
    opcua::NodeId flange_force;
    opcua::NodeId flange_torque;
};

/// Finds the nodes: of the motion device in the system to which the skill's controller belongs.
/// Errors: not_found, for a skill that moves no published arm.
opcua::Answer<KinematicsNodes> findKinematics(opcua::Client& client, const SkillAddress& skill);

/// Reads the chain, the limits and, if the server publishes it, the payload.
/// Errors: not_found, type_mismatch, with the name of what is missing or wrong;
///         invalid_argument if lists have different lengths.
opcua::Answer<opcua_skill::KinematicsData> readKinematics(opcua::Client& client,
                                                          const KinematicsNodes& nodes);

/// Reads the measured joint position [rad].
opcua::Answer<std::vector<double>> readJointPosition(opcua::Client& client,
                                                     const KinematicsNodes& nodes);
/// Reads the number of control cycles without a set-point in time, since the arm's server started.
opcua::Answer<std::uint64_t> readMissedCycles(opcua::Client& client, const KinematicsNodes& nodes);

/// Subscribes to the measured joint position [rad], at most one value per `interval`. The callback
/// runs on the client's thread.
opcua::Answer<opcua::Subscription> subscribeJointPosition(
    opcua::Client& client, const KinematicsNodes& nodes, std::chrono::milliseconds interval,
    std::function<void(const std::vector<double>&)> callback);

}  // namespace metier::client
