#pragma once

#include <string>

#include "metier/base/error.hpp"
#include "metier/opcua/address_space.hpp"
#include "metier/opcua/node_id.hpp"

namespace metier::opcua_skill {

/// A device that offers skills by itself, as a gripper does.
struct SkillController {
    opcua::NodeId controller;  ///< below DeviceSet, with ISkillControllerType
    opcua::NodeId skills;      ///< holds the skills
};

/// Finds the one such device of a server's NodeSets.
/// Threads: those of AddressSpace.
/// Errors: not_found.
Result<SkillController> findSkillController(const opcua::AddressSpace& nodes);

/// Makes an object the controller of skills: with both interfaces, the lease, and a folder for the
/// skills.
/// \return the folder
/// Errors: already_exists; not_found (NodeSets device and metier are needed).
Result<opcua::NodeId> makeSkillController(opcua::AddressSpace& nodes,
                                          const opcua::NodeId& controller);

/// Makes a controller of skills that belong to no device, below DeviceSet. Before Server::start().
/// \param name its BrowseName; \param description for people
/// Errors: as makeSkillController().
Result<SkillController> publishSkillController(opcua::AddressSpace& nodes, const std::string& name,
                                               const std::string& description);

}  // namespace metier::opcua_skill
