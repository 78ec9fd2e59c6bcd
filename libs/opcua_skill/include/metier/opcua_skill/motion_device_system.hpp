#pragma once

#include <functional>
#include <string>

#include "metier/base/error.hpp"
#include "metier/opcua/address_space.hpp"
#include "metier/opcua/node_id.hpp"
#include "metier/opcua_skill/kinematics_data.hpp"

namespace metier::opcua_skill {

/// Objects of one robot in the address space that clients look for.
struct MotionDeviceSystem {
    opcua::NodeId system;         ///< below DeviceSet
    opcua::NodeId motion_device;  ///< a SkillMotionDeviceType
    opcua::NodeId controller;     ///< with ISkillControllerType
    opcua::NodeId skills;         ///< folder of the controller's skills
    opcua::NodeId kinematics;     ///< of the motion device
};

/// Finds the one motion device system of a server's NodeSets.
/// Threads, as for all functions here: those of AddressSpace.
/// Errors: not_found, naming what is missing.
Result<MotionDeviceSystem> findMotionDeviceSystem(const opcua::AddressSpace& nodes);

/// Content of a motion device system that is made at run time.
struct MotionDeviceSystemSpec {
    std::string name;  ///< "Ur5Moves": BrowseName of the system, and prefix of all others
    std::string description;
    std::string manufacturer;
    std::string model;
    std::vector<std::string> axis_names;  ///< axis 1 first
    std::uint16_t namespace_index = 1;    ///< namespace of the new NodeIds
};

/// Makes a motion device system below DeviceSet: one motion device with Kinematics and axes, one
/// controller without skills, and notifiers up to the Server object. Call it before
/// Server::start().
/// Errors: already_exists; not_found (NodeSets device, robotics and metier are needed).
Result<MotionDeviceSystem> publishMotionDeviceSystem(opcua::AddressSpace& nodes,
                                                     const MotionDeviceSystemSpec& spec);

/// Sets the fixed values of the arm, and lets clients read its live state. `state` is called on the
/// server's thread whenever a client reads one of the live values; it must return at once.
/// Errors: invalid_argument (lists of different lengths), not_found.
Result<void> publishKinematics(opcua::AddressSpace& nodes, const MotionDeviceSystem& system,
                               const KinematicsData& data, std::function<KinematicsState()> state);

}  // namespace metier::opcua_skill
