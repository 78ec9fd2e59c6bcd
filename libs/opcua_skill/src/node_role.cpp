#include "node_role.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <utility>

#include "diagnostic.hpp"
#include "value_part.hpp"

namespace metier::opcua_skill {

namespace {

template <typename Enum>
constexpr std::uint8_t detailOf(Enum item) {
    return static_cast<std::uint8_t>(item);
}

/// The row of a table that has that path, or null.
template <typename Table>
auto* rowOf(const Table& table, std::string_view path) {
    const auto found = std::find_if(std::begin(table), std::end(table),
                                    [&](const auto& row) { return row.path == path; });
    return found == std::end(table) ? nullptr : &*found;
}

struct FixedPath {
    std::string_view path;
    NodeKind kind;
    std::uint8_t detail = 0;
};

constexpr std::array kFixedPaths{
    FixedPath{"Start", NodeKind::method, detailOf(skill::Method::start)},
    FixedPath{"Suspend", NodeKind::method, detailOf(skill::Method::suspend)},
    FixedPath{"Resume", NodeKind::method, detailOf(skill::Method::resume)},
    FixedPath{"Halt", NodeKind::method, detailOf(skill::Method::halt)},
    FixedPath{"Reset", NodeKind::method, detailOf(skill::Method::reset)},
    FixedPath{"StartWith", NodeKind::method, detailOf(skill::Method::start_with)},
    FixedPath{"Check", NodeKind::check},
    FixedPath{"GetExecution", NodeKind::get_execution},
    FixedPath{"CurrentState", NodeKind::state},
    FixedPath{"CurrentState/Id", NodeKind::state_id},
    FixedPath{"CurrentState/Number", NodeKind::state_number},
    FixedPath{"LastTransition", NodeKind::transition},
    FixedPath{"LastTransition/Id", NodeKind::transition_id},
    FixedPath{"LastTransition/Number", NodeKind::transition_number},
    FixedPath{"LastTransition/TransitionTime", NodeKind::transition_time},
    FixedPath{"FinishStateMachine/CurrentState", NodeKind::finish},
    FixedPath{"FinishStateMachine/CurrentState/Id", NodeKind::finish_id},
    FixedPath{"FinishStateMachine/CurrentState/Number", NodeKind::finish_number},
    FixedPath{"Name", NodeKind::name},
    FixedPath{"ReasonText", NodeKind::reason_text},
    FixedPath{"ExecutionId", NodeKind::execution_id},
    FixedPath{"Steps", NodeKind::steps},
    FixedPath{"CurrentStep", NodeKind::current_step},
    FixedPath{"Progress", NodeKind::progress},
};

/// The machines of sub-states, and their Variables.
constexpr std::array kSubStateMachines{
    std::pair{std::string_view("ReadySubStates/"), skill::State::ready},
    std::pair{std::string_view("RunningSubStates/"), skill::State::running},
    std::pair{std::string_view("HaltedSubStates/"), skill::State::halted},
};
constexpr std::array kSubStatePaths{
    FixedPath{"CurrentState", NodeKind::sub_state},
    FixedPath{"CurrentState/Id", NodeKind::sub_state_id},
    FixedPath{"CurrentState/Number", NodeKind::sub_state_number},
};

/// The parts of a Vector3.
constexpr std::array kVectorParts{
    FramePart{"X", Part::x},
    FramePart{"Y", Part::y},
    FramePart{"Z", Part::z},
};

std::optional<NodeRole> subStateRole(std::string_view path) {
    for (const auto& [machine, state] : kSubStateMachines) {
        const auto* row = path.starts_with(machine)
                              ? rowOf(kSubStatePaths, path.substr(machine.size()))
                              : nullptr;
        if (row != nullptr) {
            return NodeRole{row->kind, detailOf(state), 0};
        }
    }
    return std::nullopt;
}

std::optional<NodeRole> diagnosticRole(std::string_view path) {
    constexpr std::string_view kDiagnostic = "ProgramDiagnostic";
    const auto items = diagnosticItems();
    const auto* item =
        path.starts_with(kDiagnostic) ? rowOf(items, path.substr(kDiagnostic.size())) : nullptr;
    return item == nullptr
               ? std::nullopt
               : std::optional(NodeRole{NodeKind::diagnostic,
                                        static_cast<std::uint8_t>(item - items.data()), 0});
}

std::optional<NodeRole> fixedRole(std::string_view path) {
    if (const auto* row = rowOf(kFixedPaths, path)) {
        return NodeRole{row->kind, row->detail, 0};
    }
    const auto sub_state = subStateRole(path);
    return sub_state ? sub_state : diagnosticRole(path);
}

std::optional<NodeRole> partRole(NodeKind kind, std::string_view below) {
    const auto* of_frame = rowOf(kFrameParts, below);
    const auto* row = of_frame == nullptr ? rowOf(kVectorParts, below) : of_frame;
    return row == nullptr ? std::nullopt : std::optional(NodeRole{kind, detailOf(row->part), 0});
}

/// Folder of the fields of one place, and the role of their nodes.
struct FieldGroup {
    std::string_view folder;
    skill::Place place;
    NodeKind value;
    NodeKind unit;
    NodeKind range;
};

constexpr std::array kGroups{
    FieldGroup{"ParameterSet/", skill::Place::parameter_set, NodeKind::parameter,
               NodeKind::parameter_unit, NodeKind::parameter_range},
    FieldGroup{"Options/", skill::Place::options, NodeKind::parameter, NodeKind::parameter_unit,
               NodeKind::parameter_range},
    FieldGroup{"FinalResultData/", skill::Place::final_result, NodeKind::result,
               NodeKind::result_unit, NodeKind::result_range},
};

/// Nothing for a unit or range that the field does not give: the type's own holds.
std::optional<NodeRole> fieldRole(const FieldGroup& group, const skill::Field& field,
                                  std::string_view below) {
    if (below == "EngineeringUnits") {
        return field.unit == skill::kOne ? std::nullopt : std::optional(NodeRole{group.unit, 0, 0});
    }
    if (below == "EURange") {
        return field.range ? std::optional(NodeRole{group.range, 0, 0}) : std::nullopt;
    }
    return partRole(group.value, below);
}

/// Assigns one description's fields and remembers which of them were met.
class Assignment {
public:
    explicit Assignment(const skill::SkillDescription& description)
        : description_(description),
          parameter_met_(description.parameters.size()),
          result_met_(description.results.size()) {}

    std::optional<NodeRole> nodeRoleOf(std::string_view path) {
        if (const auto fixed = fixedRole(path)) {
            return fixed;
        }
        for (const auto& group : kGroups) {
            if (path.substr(0, group.folder.size()) == group.folder) {
                return inGroup(group, path.substr(group.folder.size()));
            }
        }
        return std::nullopt;
    }

    struct Missing {
        std::string path;
        bool needed = true;  ///< a parameter that has to be given
    };
    std::vector<Missing> missing() const {
        std::vector<Missing> fields;
        for (std::size_t i = 0; i < parameter_met_.size(); ++i) {
            const auto& field = description_.parameters[i];
            if (!parameter_met_[i]) {
                const auto* folder =
                    field.place == skill::Place::options ? "Options/" : "ParameterSet/";
                fields.push_back(
                    {folder + field.name, !field.optional && skill::isNull(field.default_value)});
            }
        }
        for (std::size_t i = 0; i < result_met_.size(); ++i) {
            if (!result_met_[i]) {
                fields.push_back({"FinalResultData/" + description_.results[i].name, false});
            }
        }
        return fields;
    }

private:
    std::optional<NodeRole> inGroup(const FieldGroup& group, std::string_view rest) {
        const auto slash = rest.find('/');
        const auto name = rest.substr(0, slash);
        const auto below =
            slash == std::string_view::npos ? std::string_view() : rest.substr(slash + 1);
        const bool is_result = group.place == skill::Place::final_result;
        const auto& fields = is_result ? description_.results : description_.parameters;
        const auto field = std::find_if(fields.begin(), fields.end(), [&](const auto& candidate) {
            return candidate.name == name && (is_result || candidate.place == group.place);
        });
        if (field == fields.end()) {
            return std::nullopt;
        }
        auto node_role = fieldRole(group, *field, below);
        if (node_role) {
            node_role->field = static_cast<std::uint16_t>(field - fields.begin());
            (is_result ? result_met_ : parameter_met_)[node_role->field] = true;
        }
        return node_role;
    }

    const skill::SkillDescription& description_;
    std::vector<bool> parameter_met_;
    std::vector<bool> result_met_;
};

/// Whether an instance may lack the node: it is declared as Optional, or is below such a node that
/// the instance lacks, too.
bool isOptional(const SkillLayout& declared, const SkillLayout& instance, std::string_view path) {
    for (const auto* node = rowOf(declared, path);
         node != nullptr && rowOf(instance, node->path) == nullptr;
         node = node->parent == LayoutNode::kSkill ? nullptr : &declared[node->parent]) {
        if (node->rule == LayoutNode::Rule::optional) {
            return true;
        }
    }
    return false;
}

}  // namespace

Result<std::vector<UsedNode>> assignNodeRoles(const SkillLayout& layout,
                                              const skill::SkillDescription& description,
                                              const SkillLayout& declared) {
    Assignment assignment(description);
    std::vector<UsedNode> used;
    for (std::size_t i = 0; i < layout.size(); ++i) {
        if (const auto node_role = assignment.nodeRoleOf(layout[i].path)) {
            used.push_back({i, *node_role});
        }
    }
    std::vector<std::string> missing;
    for (auto& field : assignment.missing()) {
        if (field.needed || !isOptional(declared, layout, field.path)) {
            missing.push_back(std::move(field.path));
        }
    }
    if (!missing.empty()) {
        return fail(Errc::not_found, fmt::format("{} has no node for {}", description.type,
                                                 fmt::join(missing, ", ")));
    }
    return used;
}

}  // namespace metier::opcua_skill
