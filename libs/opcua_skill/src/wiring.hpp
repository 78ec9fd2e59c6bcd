#pragma once

#include <vector>

#include "metier/opcua/address_space.hpp"
#include "metier/skill/skill.hpp"
#include "skill_factory.hpp"

namespace metier::opcua_skill {

/// The nodes of a skill object that exists which a skill of that description uses; parameters that
/// it does not use become read-only.
/// Errors: not_found, type_mismatch: each names all fields concerned.
Result<SkillInstance> wireExisting(opcua::AddressSpace& nodes, const opcua::NodeId& skill_object,
                                   const skill::SkillDescription& description);

/// Whether the values of each field may be held by its node.
/// Errors: type_mismatch, naming every field that may not.
Result<void> checkTypes(const opcua::AddressSpace& nodes, const SkillInstance& instance,
                        const skill::SkillDescription& description);

}  // namespace metier::opcua_skill
