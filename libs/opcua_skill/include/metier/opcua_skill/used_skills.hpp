#pragma once

#include <string>

#include "metier/base/error.hpp"
#include "metier/opcua/address_space.hpp"
#include "metier/opcua/node_id.hpp"

namespace metier::opcua_skill {

/// A skill of another server that a skill runs.
struct RemoteSkill {
    std::string alias;         ///< as the user calls it
    std::string endpoint_url;  ///< of its server
    std::string name;          ///< BrowseName of the skill
    std::string type_name;     ///< BrowseName of its type
    std::string controller;    ///< BrowseName of its controller; empty: none
};

// Both add a reference UsesSkill from `user`, a skill object. Threads: those of AddressSpace.
// Errors: not_found; already_exists.

/// \param used a skill object of this server
Result<void> publishUse(opcua::AddressSpace& nodes, const opcua::NodeId& user,
                        const opcua::NodeId& used);
/// Makes an object that tells where the skill is, below `UsedSkills` of the user.
Result<void> publishUse(opcua::AddressSpace& nodes, const opcua::NodeId& user,
                        const RemoteSkill& used);

/// Tells that another skill is used by an alias that was published before.
Result<void> updateUse(opcua::AddressSpace& nodes, const opcua::NodeId& user,
                       const RemoteSkill& used);

/// The skill object of that name below a folder of skills.
Result<opcua::NodeId> findSkillObject(const opcua::AddressSpace& nodes, const opcua::NodeId& skills,
                                      const std::string& name);

}  // namespace metier::opcua_skill
