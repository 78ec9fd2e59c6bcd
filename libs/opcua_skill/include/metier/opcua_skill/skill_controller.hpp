#pragma once

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

}  // namespace metier::opcua_skill
