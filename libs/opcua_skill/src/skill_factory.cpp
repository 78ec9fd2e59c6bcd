#include "skill_factory.hpp"

#include <fmt/format.h>

#include <utility>

#include "metier/opcua_skill/values.hpp"

namespace metier::opcua_skill {

namespace {

using opcua::NodeClass;
using opcua::NodeId;

constexpr std::string_view kDiagnosticParts = "ProgramDiagnostic/";
constexpr std::string_view kSequenceSkillType = "SequenceSkillType";
constexpr std::uint32_t kHashBegin = 2166136261;  // FNV-1a
constexpr std::uint32_t kHashPrime = 16777619;
constexpr std::uint32_t kFirstCompactId = 0x8000'0000;  // below: ids that people give

/// Two descriptions with the same key have the same nodes.
std::string keyOf(const skill::SkillDescription& description) {
    const bool declares = !description.steps.empty();
    std::string key = description.type + (declares ? "\nsequence" : "");
    for (const auto* fields : {&description.parameters, &description.results}) {
        for (const auto& field : *fields) {
            key +=
                fmt::format("\n{} {} {}", field.name, skill::toString(field.type), field.unit.code);
            if (field.range) {
                key += fmt::format(" {} {}", field.range->low, field.range->high);
            }
            if (declares) {
                key += " " + field.description;
            }
        }
    }
    return key;
}

std::string textOf(const NodeId& id) {
    if (const auto* text = std::get_if<std::string>(&id.identifier())) {
        return *text;
    }
    if (const auto* number = std::get_if<std::uint32_t>(&id.identifier())) {
        return std::to_string(*number);
    }
    return id.toString();
}

bool isUnit(NodeKind kind) {
    return kind == NodeKind::parameter_unit || kind == NodeKind::result_unit;
}
bool isRange(NodeKind kind) {
    return kind == NodeKind::parameter_range || kind == NodeKind::result_range;
}

const skill::Field& fieldOf(const skill::SkillDescription& description, NodeRole node_role) {
    return (isOfResult(node_role.kind) ? description.results
                                       : description.parameters)[node_role.field];
}

/// Which nodes of a layout an instance has: the mandatory ones, those with a role, and what
/// these hang below.
std::vector<bool> neededNodes(const SkillLayout& layout, const std::vector<UsedNode>& used) {
    std::vector<bool> needed(layout.size());
    for (std::size_t i = 0; i < layout.size(); ++i) {
        const auto parent = layout[i].parent;
        needed[i] = layout[i].rule == LayoutNode::Rule::mandatory &&
                    (parent == LayoutNode::kSkill || needed[parent]);
    }
    for (const auto& node : used) {
        for (auto i = node.index; i != LayoutNode::kSkill && !needed[i]; i = layout[i].parent) {
            needed[i] = true;
        }
    }
    // A mandatory child of a node that is needed only for another one.
    for (std::size_t i = 0; i < layout.size(); ++i) {
        const auto parent = layout[i].parent;
        if (layout[i].rule == LayoutNode::Rule::mandatory && parent != LayoutNode::kSkill) {
            needed[i] = needed[i] || needed[parent];
        }
    }
    return needed;
}

bool isOf(std::string_view path, std::string_view node) {
    return path == node || (path.substr(0, node.size()) == node && path[node.size()] == '/');
}

/// Removes nodes: a compact instance has its diagnostic as one value only, and only the methods of
/// Part 10.
void dropWhatCompactLacks(SkillLayout& layout) {
    for (auto& node : layout) {
        const bool dropped = node.path.substr(0, kDiagnosticParts.size()) == kDiagnosticParts ||
                             isOf(node.path, "StartWith") || isOf(node.path, "ExecutionId") ||
                             isOf(node.path, "Check") || isOf(node.path, "GetExecution");
        if (dropped) {
            node.path.clear();
            node.rule = LayoutNode::Rule::optional;
        }
    }
}

/// The type's own nodes, in the place of an instance's.
SkillInstance declarationsOf(const SkillLayout& layout, const std::vector<UsedNode>& used) {
    SkillInstance declarations;
    for (const auto& node : used) {
        declarations.nodes.push_back({layout[node.index].reference.target, node.node_role});
    }
    return declarations;
}

}  // namespace

Result<SkillInstance> SkillFactory::make(const NodeId& skills,
                                         const skill::SkillDescription& description,
                                         NodeStyle style) {
    METIER_ASSIGN(auto plan, planFor(description, style));
    const std::string prefix = textOf(skills) + "/" + description.name;
    SkillInstance instance{style == NodeStyle::readable
                               ? NodeId(skills.namespaceIndex(), prefix)
                               : compactId(skills.namespaceIndex(), prefix),
                           {}};
    // A compact id never meets its twin, so the path is looked at as well.
    if (made_.contains(prefix)) {
        return fail(Errc::already_exists, prefix + " is there already");
    }
    METIER_TRY(addObject(skills, instance.id, description, plan->type));
    made_.insert(prefix);
    std::vector<NodeId> made;
    made.reserve(plan->steps.size());
    for (const auto& step : plan->steps) {
        const NodeId& parent = step.parent == LayoutNode::kSkill ? instance.id : made[step.parent];
        METIER_ASSIGN(auto node, addNode(step, parent, prefix, style));
        made.push_back(node);
        if (step.node_role && !step.shared) {
            instance.nodes.push_back({std::move(node), *step.node_role});
        }
    }
    return instance;
}

Result<const SkillFactory::Plan*> SkillFactory::planFor(const skill::SkillDescription& description,
                                                        NodeStyle style) {
    auto key = keyOf(description) + (style == NodeStyle::compact ? "\ncompact" : "");
    auto found = plans_.find(key);
    if (found == plans_.end()) {
        METIER_ASSIGN(auto plan, makePlan(description, style));
        found = plans_.emplace(std::move(key), std::move(plan)).first;
    }
    return &found->second;
}

/// A composed skill may be of a type that others are of, too; else it is a SequenceSkill.
Result<NodeId> SkillFactory::typeFor(const skill::SkillDescription& description) const {
    auto type = findType(ids_.skill_type, description.type);
    return type || description.steps.empty() ? type : findType(ids_.skill_type, kSequenceSkillType);
}

Result<SkillLayout> SkillFactory::layoutFor(const skill::SkillDescription& description,
                                            const NodeId& type) const {
    if (description.steps.empty()) {
        return layoutOfType(nodes_, type);
    }
    METIER_ASSIGN(const auto sequence, findType(ids_.skill_type, kSequenceSkillType));
    auto layout = layoutOfType(nodes_, type, sequence);
    if (layout) {
        METIER_TRY(addDeclaredFields(nodes_, sequence, description, *layout));
    }
    return layout;
}

Result<SkillFactory::Plan> SkillFactory::makePlan(const skill::SkillDescription& description,
                                                  NodeStyle style) {
    METIER_ASSIGN(auto type, typeFor(description));
    METIER_ASSIGN(auto layout, layoutFor(description, type));
    if (style == NodeStyle::compact) {
        dropWhatCompactLacks(layout);
    }
    METIER_ASSIGN(auto used, assignNodeRoles(layout, description));
    METIER_TRY(checkTypes(nodes_, declarationsOf(layout, used), description));
    const auto needed = neededNodes(layout, used);
    std::vector<std::size_t> step_of(layout.size());
    std::vector<bool> has_children(layout.size());
    for (std::size_t i = 0; i < layout.size(); ++i) {
        if (needed[i] && layout[i].parent != LayoutNode::kSkill) {
            has_children[layout[i].parent] = true;
        }
    }
    Plan plan{type, {}};
    auto next_used = used.begin();
    for (std::size_t i = 0; i < layout.size(); ++i) {
        auto& node = layout[i];
        Step step;
        if (next_used != used.end() && next_used->index == i) {
            step.node_role = next_used++->node_role;
        }
        if (!needed[i]) {
            continue;
        }
        step.parent = node.parent == LayoutNode::kSkill ? node.parent : step_of[node.parent];
        step.path = std::move(node.path);
        step.declaration = std::move(node.reference);
        METIER_TRY(describe(step));
        if (node.declared_by_skill) {
            takeFrom(fieldOf(description, *step.node_role), step);
        }
        step.shared = !has_children[i] && serves(step, description);
        step_of[i] = plan.steps.size();
        plan.steps.push_back(std::move(step));
    }
    return plan;
}

/// A placeholder says little: the field itself says what its node is like.
void SkillFactory::takeFrom(const skill::Field& field, Step& step) {
    step.shape = shapeOf(field.type);
    step.description = {"en", field.description};
}

Result<void> SkillFactory::describe(Step& step) const {
    METIER_ASSIGN(step.description, nodes_.descriptionOf(step.declaration.target));
    if (step.declaration.node_class != NodeClass::variable) {
        return {};
    }
    METIER_ASSIGN(step.shape, nodes_.shapeOf(step.declaration.target));
    METIER_ASSIGN(auto read, nodes_.read(step.declaration.target));
    step.value = std::move(read.value);
    return {};
}

bool SkillFactory::serves(const Step& step, const skill::SkillDescription& description) {
    if (step.declaration.node_class != NodeClass::variable) {
        return false;
    }
    if (!step.node_role) {
        return true;
    }
    if (isUnit(step.node_role->kind)) {
        const auto declared = step.value.as<opcua::EuInformation>();
        const auto wanted = toOpcua(fieldOf(description, *step.node_role).unit);
        return declared && declared->unit_id == wanted.unit_id;
    }
    if (isRange(step.node_role->kind)) {
        const auto declared = step.value.as<opcua::Range>();
        const auto& wanted = *fieldOf(description, *step.node_role).range;
        return declared && *declared == wanted;
    }
    return false;
}

Result<NodeId> SkillFactory::findType(const NodeId& base, std::string_view name) const {
    METIER_ASSIGN(auto subtypes, nodes_.browse(base, {opcua::ids::kHasSubtype}));
    for (const auto& subtype : subtypes) {
        if (subtype.browse_name.name == name || subtype.browse_name.name + "Type" == name) {
            return subtype.target;
        }
        if (auto found = findType(subtype.target, name)) {
            return found;
        }
    }
    return fail(Errc::not_found, "no skill type " + std::string(name));
}

Result<void> SkillFactory::addObject(const NodeId& skills, const NodeId& id,
                                     const skill::SkillDescription& description,
                                     const NodeId& type) {
    METIER_TRY(nodes_.addObject({.node = {.id = id,
                                          .parent = skills,
                                          .browse_name = {id.namespaceIndex(), description.name},
                                          .description = {"en", description.description}},
                                 .type = type,
                                 .event_notifier = opcua::EventNotifier::subscribable,
                                 .children = opcua::Children::none}));
    auto owners =
        nodes_.browse(skills, {opcua::ids::kHasComponent, opcua::BrowseFilter::Direction::inverse});
    if (!owners || owners->empty()) {
        return {};
    }
    return nodes_.addReference(owners->front().target, opcua::ids::kHasNotifier, id);
}

Result<NodeId> SkillFactory::addNode(const Step& step, const NodeId& parent,
                                     const std::string& prefix, NodeStyle style) {
    if (step.shared) {
        return nodes_.addReference(parent, step.declaration.type, step.declaration.target).map([&] {
            return step.declaration.target;
        });
    }
    opcua::NodeSpec node;
    const std::string path = prefix + "/" + step.path;
    node.parent = parent;
    node.reference = step.declaration.type;
    node.browse_name = step.declaration.browse_name;
    if (style == NodeStyle::readable) {
        node.id = NodeId(parent.namespaceIndex(), path);
        node.description = step.description;
    } else {
        node.id = compactId(parent.namespaceIndex(), path);
    }
    switch (step.declaration.node_class) {
        case NodeClass::method:
            return nodes_.addMethod({.node = std::move(node)});
        case NodeClass::object:
            return nodes_.addObject({.node = std::move(node),
                                     .type = step.declaration.type_definition,
                                     .children = opcua::Children::none});
        default:
            break;
    }
    const bool writable = step.node_role && step.node_role->kind == NodeKind::parameter;
    return nodes_.addVariable({.node = std::move(node),
                               .type = step.declaration.type_definition,
                               .data_type = step.shape.data_type,
                               .value_rank = step.shape.value_rank,
                               .array_dimensions = step.shape.array_dimensions,
                               .value = step.node_role ? opcua::Value() : step.value,
                               .access = writable ? opcua::Access::read_write : opcua::Access::read,
                               .children = opcua::Children::none});
}

NodeId SkillFactory::compactId(std::uint16_t index, std::string_view path) const {
    std::uint32_t hash = kHashBegin;
    for (const char letter : path) {
        hash = (hash ^ static_cast<unsigned char>(letter)) * kHashPrime;
    }
    NodeId id(index, hash | kFirstCompactId);
    while (nodes_.exists(id)) {
        id = NodeId(index, ++hash | kFirstCompactId);
    }
    return id;
}

}  // namespace metier::opcua_skill
