#include "purpose.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <utility>

namespace metier::opcua_skill {

namespace {

constexpr std::uint8_t detailOf(skill::Method method) {
    return static_cast<std::uint8_t>(method);
}
constexpr std::uint8_t detailOf(skill::State state) {
    return static_cast<std::uint8_t>(state);
}
constexpr std::uint8_t detailOf(Part part) {
    return static_cast<std::uint8_t>(part);
}
constexpr std::uint8_t detailOf(DiagnosticItem item) {
    return static_cast<std::uint8_t>(item);
}

struct FixedPath {
    std::string_view path;
    Role role;
    std::uint8_t detail = 0;
};

constexpr std::array kFixedPaths{
    FixedPath{"Start", Role::method, detailOf(skill::Method::start)},
    FixedPath{"Suspend", Role::method, detailOf(skill::Method::suspend)},
    FixedPath{"Resume", Role::method, detailOf(skill::Method::resume)},
    FixedPath{"Halt", Role::method, detailOf(skill::Method::halt)},
    FixedPath{"Reset", Role::method, detailOf(skill::Method::reset)},
    FixedPath{"StartWith", Role::method, detailOf(skill::Method::start_with)},
    FixedPath{"Check", Role::check},
    FixedPath{"GetExecution", Role::get_execution},
    FixedPath{"CurrentState", Role::state},
    FixedPath{"CurrentState/Id", Role::state_id},
    FixedPath{"CurrentState/Number", Role::state_number},
    FixedPath{"LastTransition", Role::transition},
    FixedPath{"LastTransition/Id", Role::transition_id},
    FixedPath{"LastTransition/Number", Role::transition_number},
    FixedPath{"LastTransition/TransitionTime", Role::transition_time},
    FixedPath{"ReasonText", Role::reason_text},
    FixedPath{"ExecutionId", Role::execution_id},
    FixedPath{"Steps", Role::steps},
    FixedPath{"CurrentStep", Role::current_step},
    FixedPath{"Progress", Role::progress},
    FixedPath{"ReadySubStates/CurrentState", Role::sub_state, detailOf(skill::State::ready)},
    FixedPath{"ReadySubStates/CurrentState/Id", Role::sub_state_id, detailOf(skill::State::ready)},
    FixedPath{"ReadySubStates/CurrentState/Number", Role::sub_state_number,
              detailOf(skill::State::ready)},
    FixedPath{"RunningSubStates/CurrentState", Role::sub_state, detailOf(skill::State::running)},
    FixedPath{"RunningSubStates/CurrentState/Id", Role::sub_state_id,
              detailOf(skill::State::running)},
    FixedPath{"RunningSubStates/CurrentState/Number", Role::sub_state_number,
              detailOf(skill::State::running)},
    FixedPath{"HaltedSubStates/CurrentState", Role::sub_state, detailOf(skill::State::halted)},
    FixedPath{"HaltedSubStates/CurrentState/Id", Role::sub_state_id,
              detailOf(skill::State::halted)},
    FixedPath{"HaltedSubStates/CurrentState/Number", Role::sub_state_number,
              detailOf(skill::State::halted)},
    FixedPath{"ProgramDiagnostic", Role::diagnostic, detailOf(DiagnosticItem::whole)},
    FixedPath{"ProgramDiagnostic/CreateSessionId", Role::diagnostic,
              detailOf(DiagnosticItem::create_session_id)},
    FixedPath{"ProgramDiagnostic/CreateClientName", Role::diagnostic,
              detailOf(DiagnosticItem::create_client_name)},
    FixedPath{"ProgramDiagnostic/InvocationCreationTime", Role::diagnostic,
              detailOf(DiagnosticItem::invocation_creation_time)},
    FixedPath{"ProgramDiagnostic/LastTransitionTime", Role::diagnostic,
              detailOf(DiagnosticItem::last_transition_time)},
    FixedPath{"ProgramDiagnostic/LastMethodCall", Role::diagnostic,
              detailOf(DiagnosticItem::last_method_call)},
    FixedPath{"ProgramDiagnostic/LastMethodSessionId", Role::diagnostic,
              detailOf(DiagnosticItem::last_method_session_id)},
    FixedPath{"ProgramDiagnostic/LastMethodInputArguments", Role::diagnostic,
              detailOf(DiagnosticItem::last_method_input_arguments)},
    FixedPath{"ProgramDiagnostic/LastMethodOutputArguments", Role::diagnostic,
              detailOf(DiagnosticItem::last_method_output_arguments)},
    FixedPath{"ProgramDiagnostic/LastMethodInputValues", Role::diagnostic,
              detailOf(DiagnosticItem::last_method_input_values)},
    FixedPath{"ProgramDiagnostic/LastMethodOutputValues", Role::diagnostic,
              detailOf(DiagnosticItem::last_method_output_values)},
    FixedPath{"ProgramDiagnostic/LastMethodCallTime", Role::diagnostic,
              detailOf(DiagnosticItem::last_method_call_time)},
    FixedPath{"ProgramDiagnostic/LastMethodReturnStatus", Role::diagnostic,
              detailOf(DiagnosticItem::last_method_return_status)},
};

struct PartPath {
    std::string_view path;
    Part part;
};

constexpr std::array kPartPaths{
    PartPath{"", Part::whole},
    PartPath{"CartesianCoordinates", Part::position},
    PartPath{"CartesianCoordinates/X", Part::x},
    PartPath{"CartesianCoordinates/Y", Part::y},
    PartPath{"CartesianCoordinates/Z", Part::z},
    PartPath{"Orientation", Part::orientation},
    PartPath{"Orientation/A", Part::a},
    PartPath{"Orientation/B", Part::b},
    PartPath{"Orientation/C", Part::c},
    PartPath{"X", Part::x},
    PartPath{"Y", Part::y},
    PartPath{"Z", Part::z},
};

std::optional<Purpose> fixedPurpose(std::string_view path) {
    const auto* found = std::find_if(kFixedPaths.begin(), kFixedPaths.end(),
                                     [&](const FixedPath& fixed) { return fixed.path == path; });
    if (found == kFixedPaths.end()) {
        return std::nullopt;
    }
    return Purpose{found->role, found->detail, 0};
}

std::optional<Purpose> partPurpose(Role role, std::string_view below) {
    const auto* found = std::find_if(kPartPaths.begin(), kPartPaths.end(),
                                     [&](const PartPath& part) { return part.path == below; });
    if (found == kPartPaths.end()) {
        return std::nullopt;
    }
    return Purpose{role, detailOf(found->part), 0};
}

/// Where the fields of one place hang, and what their nodes are for.
struct FieldGroup {
    std::string_view folder;
    skill::Place place;
    Role value;
    Role unit;
    Role range;
};

constexpr std::array kGroups{
    FieldGroup{"ParameterSet/", skill::Place::parameter_set, Role::parameter, Role::parameter_unit,
               Role::parameter_range},
    FieldGroup{"Options/", skill::Place::options, Role::parameter, Role::parameter_unit,
               Role::parameter_range},
    FieldGroup{"FinalResultData/", skill::Place::final_result, Role::result, Role::result_unit,
               Role::result_range},
};

/// Nothing for a unit or range that the field does not give: the type's own holds.
std::optional<Purpose> fieldPurpose(const FieldGroup& group, const skill::Field& field,
                                    std::string_view below) {
    if (below == "EngineeringUnits") {
        return field.unit == skill::kOne ? std::nullopt : std::optional(Purpose{group.unit, 0, 0});
    }
    if (below == "EURange") {
        return field.range ? std::optional(Purpose{group.range, 0, 0}) : std::nullopt;
    }
    return partPurpose(group.value, below);
}

/// Assigns one description's fields and remembers which of them were met.
class Assignment {
public:
    explicit Assignment(const skill::SkillDescription& description)
        : description_(description),
          parameter_met_(description.parameters.size()),
          result_met_(description.results.size()) {}

    std::optional<Purpose> purposeOf(std::string_view path) {
        if (const auto fixed = fixedPurpose(path)) {
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
    std::optional<Purpose> inGroup(const FieldGroup& group, std::string_view rest) {
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
        auto purpose = fieldPurpose(group, *field, below);
        if (purpose) {
            purpose->field = static_cast<std::uint16_t>(field - fields.begin());
            (is_result ? result_met_ : parameter_met_)[purpose->field] = true;
        }
        return purpose;
    }

    const skill::SkillDescription& description_;
    std::vector<bool> parameter_met_;
    std::vector<bool> result_met_;
};

const LayoutNode* findNode(const SkillLayout& layout, std::string_view path) {
    const auto found = std::find_if(layout.begin(), layout.end(),
                                    [&](const LayoutNode& node) { return node.path == path; });
    return found == layout.end() ? nullptr : &*found;
}

/// Whether an instance may lack the node: it is declared as Optional, or hangs below such a one
/// that the instance lacks, too.
bool isOptional(const SkillLayout& declared, const SkillLayout& instance, std::string_view path) {
    for (const auto* node = findNode(declared, path);
         node != nullptr && findNode(instance, node->path) == nullptr;
         node = node->parent == LayoutNode::kSkill ? nullptr : &declared[node->parent]) {
        if (node->rule == LayoutNode::Rule::optional) {
            return true;
        }
    }
    return false;
}

}  // namespace

Result<std::vector<UsedNode>> assignPurposes(const SkillLayout& layout,
                                             const skill::SkillDescription& description,
                                             const SkillLayout& declared) {
    Assignment assignment(description);
    std::vector<UsedNode> used;
    for (std::size_t i = 0; i < layout.size(); ++i) {
        if (const auto purpose = assignment.purposeOf(layout[i].path)) {
            used.push_back({i, *purpose});
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
