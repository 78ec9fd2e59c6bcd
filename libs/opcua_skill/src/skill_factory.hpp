#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "metier/opcua/address_space.hpp"
#include "metier/opcua_skill/skill_server.hpp"
#include "metier/skill/skill.hpp"
#include "model_ids.hpp"
#include "node_role.hpp"
#include "skill_layout.hpp"

namespace metier::opcua_skill {

/// A node of an instance, and what it is for.
struct BoundNode {
    opcua::NodeId id;
    NodeRole node_role;
};

/// A skill object and those of its nodes that lead to the Program.
struct SkillInstance {
    opcua::NodeId id;
    std::vector<BoundNode> nodes;
};

/// The nodes of a skill object that exists which a skill of that description uses; parameters that
/// it does not use become read-only.
/// Errors: not_found, type_mismatch: each names all fields concerned.
Result<SkillInstance> wireExisting(opcua::AddressSpace& nodes, const opcua::NodeId& skill_object,
                                   const skill::SkillDescription& description);

/// Whether the values of each field may be held by its node.
/// Errors: type_mismatch, naming every field that may not.
Result<void> checkTypes(const opcua::AddressSpace& nodes, const SkillInstance& instance,
                        const skill::SkillDescription& description);

/// Makes skill objects at run time. What a type looks like is read once, so that thousands of
/// instances cost little more than their nodes.
///
/// Threading: that of AddressSpace.
class SkillFactory {
public:
    SkillFactory(opcua::AddressSpace& nodes, const ModelIds& ids) : nodes_(nodes), ids_(ids) {}

    /// Makes an instance of the description's type below `skills`.
    /// Errors: not_found (type, or fields: all are named), already_exists.
    Result<SkillInstance> make(const opcua::NodeId& skills,
                               const skill::SkillDescription& description, NodeStyle style);

private:
    /// A node to make for each instance, or to refer to in the type.
    struct Step {
        std::size_t parent = LayoutNode::kSkill;  ///< index of a step
        bool shared = false;                      ///< the type's own node serves
        std::optional<NodeRole> node_role;
        std::string path;
        opcua::Reference declaration;
        opcua::LocalizedText description;
        opcua::VariableShape shape;
        opcua::Value value;
    };
    struct Plan {
        opcua::NodeId type;
        std::vector<Step> steps;
    };

    Result<const Plan*> planFor(const skill::SkillDescription& description, NodeStyle style);
    Result<opcua::NodeId> typeFor(const skill::SkillDescription& description) const;
    Result<SkillLayout> layoutFor(const skill::SkillDescription& description,
                                  const opcua::NodeId& type) const;
    Result<Plan> makePlan(const skill::SkillDescription& description, NodeStyle style);
    Result<void> describe(Step& step) const;
    static void takeFrom(const skill::Field& field, Step& step);
    /// Whether the type's own node says what the instance has to say.
    static bool serves(const Step& step, const skill::SkillDescription& description);
    Result<opcua::NodeId> findType(const opcua::NodeId& base, std::string_view name) const;
    Result<void> addObject(const opcua::NodeId& skills, const opcua::NodeId& id,
                           const skill::SkillDescription& description, const opcua::NodeId& type);
    Result<opcua::NodeId> addNode(const Step& step, const opcua::NodeId& parent,
                                  const std::string& prefix, NodeStyle style);
    /// A numeric id that follows from the path.
    opcua::NodeId compactId(std::uint16_t index, std::string_view path) const;

    opcua::AddressSpace& nodes_;
    const ModelIds& ids_;
    std::set<std::string> made_;         ///< paths of the instances
    std::map<std::string, Plan> plans_;  ///< key: type and fields
};

}  // namespace metier::opcua_skill
