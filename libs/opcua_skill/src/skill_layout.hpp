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
    opcua::Reference reference;   ///< from the node above; its target is the node described
    Rule rule = Rule::mandatory;
    /// A field that the skill declares by itself stands for the type's placeholder.
    bool declared_by_skill = false;
};

/// All nodes below a skill; each comes after the one above it.
using SkillLayout = std::vector<LayoutNode>;

/// What an instance of `type` has: inherited and of interfaces, the nearest declaration first.
/// Errors: not_found.
/// \param also what it has besides as an instance of that type, too; null: nothing
Result<SkillLayout> layoutOfType(const opcua::AddressSpace& nodes, const opcua::NodeId& type,
                                 const opcua::NodeId& also = {});

/// What `instance` has.
/// Errors: not_found.
Result<SkillLayout> layoutOfInstance(const opcua::AddressSpace& nodes,
                                     const opcua::NodeId& instance);

/// Adds nodes for the fields of `description` that have none yet, in the place of the placeholders
/// of the SequenceSkillType `type`.
/// Errors: not_found, if the type has no placeholder.
Result<void> addDeclaredFields(const opcua::AddressSpace& nodes, const opcua::NodeId& type,
                               const skill::SkillDescription& description, SkillLayout& layout);

}  // namespace metier::opcua_skill
