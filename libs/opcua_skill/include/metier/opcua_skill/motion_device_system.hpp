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
    /// MotionDeviceSystem (OPC 40010-1), below DeviceSet.
    opcua::NodeId system;
    /// Arm: a SkillMotionDeviceType.
    opcua::NodeId motion_device;
    /// Controller with ISkillControllerType.
    opcua::NodeId controller;
    /// Folder of the controller's skills.
    opcua::NodeId skills;
    /// Object Kinematics of the motion device.
    opcua::NodeId kinematics;
};

/// Finds the motion device system of a server's NodeSets; the first one if there are several.
/// Threads, as for all functions here: those of AddressSpace.
/// Errors: not_found, naming what is missing.
Result<MotionDeviceSystem> findMotionDeviceSystem(const opcua::AddressSpace& nodes);

/// Content of a motion device system that is made at run time.
struct MotionDeviceSystemSpec {
    /// BrowseName of the system and prefix of all others: "Ur5Moves".
    std::string name;
    /// Text for people.
    std::string description;
    /// Manufacturer and Model of arm and controller.
    std::string manufacturer;
    std::string model;
    /// DisplayNames of the axes, axis 1 first; one AxisType is made for each.
    std::vector<std::string> axis_names;
    /// Namespace of the new NodeIds; 1 is the server's own.
    std::uint16_t namespace_index = 1;
};

/// Makes a motion device system below DeviceSet with what OPC 40010-1 makes mandatory: a motion
/// device with Kinematics, axes and motors, a controller without skills and a safety state; and
/// notifiers up to the Server object. Call it before Server::start().
/// Errors: already_exists; not_found (NodeSets device, robotics and metier are needed).
Result<MotionDeviceSystem> publishMotionDeviceSystem(opcua::AddressSpace& nodes,
                                                     const MotionDeviceSystemSpec& spec);

/// Sets the fixed values of the arm and serves the live ones; those nobody knows are BadNoData.
/// \param state called on the server's thread whenever a client reads one of the live values, and
///              at each sampling; it must return at once and stay valid until the server has
///              stopped
/// Errors: invalid_argument (lists of different lengths), not_found.
Result<void> publishKinematics(opcua::AddressSpace& nodes, const MotionDeviceSystem& system,
                               const KinematicsData& data, std::function<KinematicsState()> state);

}  // namespace metier::opcua_skill
