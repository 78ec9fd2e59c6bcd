#pragma once

#include <string>
#include <string_view>

#include "metier/base/error.hpp"
#include "metier/opcua/address_space.hpp"
#include "metier/opcua/node_id.hpp"

namespace metier::opcua_skill {

/// A skill of another server that a skill of this server uses.
struct RemoteSkill {
    /// Name that the using skill gives it; unique within that skill.
    std::string alias;
    /// Address of its server: "opc.tcp://host:port".
    std::string endpoint_url;
    /// BrowseName of the skill.
    std::string name;
    /// BrowseName of its type.
    std::string type_name;
    /// BrowseName of its controller; empty: none.
    std::string controller;
};

// Both functions add a reference UsesSkill from `user`, a skill object. Threads: those of
// AddressSpace. Errors: not_found; already_exists.

/// \param used a skill object of this server
Result<void> publishUse(opcua::AddressSpace& nodes, const opcua::NodeId& user,
                        const opcua::NodeId& used);
/// Adds an object below `UsedSkills` of the user that holds the address of the used skill.
Result<void> publishUse(opcua::AddressSpace& nodes, const opcua::NodeId& user,
                        const RemoteSkill& used);

/// Replaces the address of the skill that is used by an alias published before.
Result<void> updateUse(opcua::AddressSpace& nodes, const opcua::NodeId& user,
                       const RemoteSkill& used);

/// Adds the Property `Recipe` to a skill object: the composition file that it was made of, so that
/// anybody can read what the skill does.
/// \param recipe TOML text (docs/guide/compose.md)
Result<void> publishRecipe(opcua::AddressSpace& nodes, const opcua::NodeId& skill,
                           const std::string& recipe);

/// Name of that Property, in metier's namespace.
inline constexpr std::string_view kRecipe = "Recipe";

/// Finds the skill object of that name below a folder of skills. Errors: not_found.
Result<opcua::NodeId> findSkillObject(const opcua::AddressSpace& nodes, const opcua::NodeId& skills,
                                      const std::string& name);

}  // namespace metier::opcua_skill
