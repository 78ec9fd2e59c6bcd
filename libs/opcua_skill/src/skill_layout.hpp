#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "metier/base/error.hpp"
#include "metier/opcua/address_space.hpp"
#include "metier/skill/skill.hpp"

namespace metier::opcua_skill {

/// One node below a skill, as its type declares it or as the instance has it.
struct LayoutNode {
    enum class Rule : std::uint8_t { mandatory, optional };
    static constexpr std::size_t kSkill = std::numeric_limits<std::size_t>::max();

    std::string path;             ///< names only: "ParameterSet/MaxVelocity/EURange"
    std::size_t parent = kSkill;  ///< index of the node above; kSkill: the skill object itself
    /// Reference from the node above; its target is the node described
    opcua::Reference reference;
    Rule rule = Rule::mandatory;
    /// A field that the skill declares by itself stands for the type's placeholder.
    bool declared_by_skill = false;
};

/// All nodes below a skill; each comes after the one above it.
using SkillLayout = std::vector<LayoutNode>;

/// Nodes of an instance of `type`: inherited ones and those of interfaces, the nearest declaration
/// first.
/// Errors: not_found.
/// \param also further type whose nodes the instance has, too; null: none
Result<SkillLayout> layoutOfType(const opcua::AddressSpace& nodes, const opcua::NodeId& type,
                                 const opcua::NodeId& also = {});

/// Nodes of `instance`.
/// Errors: not_found.
Result<SkillLayout> layoutOfInstance(const opcua::AddressSpace& nodes,
                                     const opcua::NodeId& instance);

/// Adds nodes for those fields of `description` that have none yet, made from the placeholders of
/// the SequenceSkillType `type`.
/// Errors: not_found, if the type has no placeholder.
Result<void> addDeclaredFields(const opcua::AddressSpace& nodes, const opcua::NodeId& type,
                               const skill::SkillDescription& description, SkillLayout& layout);

}  // namespace metier::opcua_skill
