#pragma once

#include <string>

#include "metier/base/error.hpp"
#include "metier/opcua/address_space.hpp"
#include "metier/opcua/node_id.hpp"

namespace metier::opcua_skill {

/// A device that publishes skills by itself, such as a gripper.
struct SkillController {
    /// Object below DeviceSet, with ISkillControllerType.
    opcua::NodeId controller;
    /// Folder of its skills.
    opcua::NodeId skills;
};

/// Finds such a device among a server's NodeSets: the first object below DeviceSet that has skills.
/// Threads, as for all functions here: those of AddressSpace.
/// Errors: not_found.
Result<SkillController> findSkillController(const opcua::AddressSpace& nodes);

/// Makes an object a controller of skills: adds both interfaces, the lease, a DI Lock, and a folder
/// for skills. Serve the lease by SkillServer::serveControl().
/// \return the folder
/// Errors: already_exists; not_found (NodeSets device and metier are needed).
Result<opcua::NodeId> makeSkillController(opcua::AddressSpace& nodes,
                                          const opcua::NodeId& controller);

/// Makes a controller below DeviceSet for skills that belong to no device. Call it before
/// Server::start().
/// \param name BrowseName of the controller
/// \param description text for people
/// Errors: as makeSkillController().
Result<SkillController> publishSkillController(opcua::AddressSpace& nodes, const std::string& name,
                                               const std::string& description);

}  // namespace metier::opcua_skill
