#include "skill_factory.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <utility>

#include "metier/opcua_skill/values.hpp"
#include "skill_layout.hpp"

namespace metier::opcua_skill {

namespace {

using opcua::AddressSpace;
using opcua::NodeId;

const NodeId kInt32{0, 6U};
const NodeId kEnumeration{0, 29U};
constexpr std::int32_t kAnyRank = -2;
constexpr std::int32_t kScalarOrArray = -3;

bool isSubtypeOf(const AddressSpace& nodes, NodeId type, const NodeId& base) {
    while (type != base) {
        auto above =
            nodes.browse(type, {opcua::ids::kHasSubtype, opcua::BrowseFilter::Direction::inverse});
        if (!above || above->empty()) {
            return false;
        }
        type = above->front().target;
    }
    return true;
}

bool holds(const AddressSpace& nodes, const opcua::VariableShape& node, skill::ValueType type) {
    const auto wanted = shapeOf(type);
    const bool rank_fits = node.value_rank == wanted.value_rank || node.value_rank == kAnyRank ||
                           node.value_rank == kScalarOrArray;
    const bool is_enumeration =
        wanted.data_type == kInt32 && isSubtypeOf(nodes, node.data_type, kEnumeration);
    return rank_fits && (is_enumeration || node.data_type == opcua::ids::kBaseDataType ||
                         isSubtypeOf(nodes, node.data_type, wanted.data_type));
}

bool isParameterPath(std::string_view path) {
    return path.substr(0, 13) == "ParameterSet/" || path.substr(0, 8) == "Options/";
}

/// Declarations of the type of an instance.
Result<SkillLayout> declarationsOf(const AddressSpace& nodes, const NodeId& instance) {
    METIER_ASSIGN(const auto types, nodes.browse(instance, {opcua::ids::kHasTypeDefinition}));
    return types.empty() ? SkillLayout() : layoutOfType(nodes, types.front().target);
}

}  // namespace

Result<void> checkTypes(const AddressSpace& nodes, const SkillInstance& instance,
                        const skill::SkillDescription& description) {
    std::vector<std::string> wrong;
    for (const auto& [id, node_role] : instance.nodes) {
        const bool is_result = node_role.kind == NodeKind::result;
        if ((node_role.kind != NodeKind::parameter && !is_result) ||
            static_cast<Part>(node_role.detail) != Part::whole) {
            continue;
        }
        const auto& fields = is_result ? description.results : description.parameters;
        const auto& field = fields[node_role.field];
        const auto shape = nodes.shapeOf(id);
        if (!shape || !holds(nodes, *shape, field.type)) {
            wrong.push_back(fmt::format("{} ({})", field.name, skill::toString(field.type)));
        }
    }
    if (!wrong.empty()) {
        return fail(Errc::type_mismatch, fmt::format("{}: the nodes of {} have another data type",
                                                     description.type, fmt::join(wrong, ", ")));
    }
    return {};
}

Result<SkillInstance> wireExisting(AddressSpace& nodes, const NodeId& skill_object,
                                   const skill::SkillDescription& description) {
    METIER_ASSIGN(auto layout, layoutOfInstance(nodes, skill_object));
    METIER_ASSIGN(const auto declared, declarationsOf(nodes, skill_object));
    METIER_ASSIGN(auto used, assignNodeRoles(layout, description, declared));
    SkillInstance instance{skill_object, {}};
    auto next_used = used.begin();
    for (std::size_t i = 0; i < layout.size(); ++i) {
        const auto& node = layout[i];
        if (next_used != used.end() && next_used->index == i) {
            instance.nodes.push_back({node.reference.target, next_used++->node_role});
        } else if (isParameterPath(node.path) &&
                   node.reference.node_class == opcua::NodeClass::variable) {
            METIER_TRY(nodes.setAccess(node.reference.target, opcua::Access::read));
        }
    }
    METIER_TRY(checkTypes(nodes, instance, description));
    return instance;
}

}  // namespace metier::opcua_skill
