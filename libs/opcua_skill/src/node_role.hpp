#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "metier/skill/skill.hpp"
#include "skill_layout.hpp"

namespace metier::opcua_skill {

/// Meaning of a node below a skill.
enum class NodeKind : std::uint8_t {
    method,  ///< detail: skill::Method
    check,
    get_execution,
    state,
    state_id,
    state_number,
    transition,
    transition_id,
    transition_number,
    transition_time,
    sub_state,  ///< detail, also of the next two: the skill::State that it belongs to
    sub_state_id,
    sub_state_number,
    finish,  ///< how the last execution ended, by FinishStateMachineType
    finish_id,
    finish_number,
    parameter,       ///< detail: Part
    parameter_unit,  ///< detail: Part
    parameter_range,
    result,  ///< detail: Part
    result_unit,
    result_range,
    diagnostic,  ///< detail: index in diagnosticItems()
    reason_text,
    execution_id,
    steps,  ///< step names of a sequence
    current_step,
    progress,
    name,
};

/// Which part of a value a Variable holds.
enum class Part : std::uint8_t { whole, position, orientation, x, y, z, a, b, c };

/// Whether the node belongs to a result: its value, unit or range.
constexpr bool isOfResult(NodeKind kind) noexcept {
    return kind == NodeKind::result || kind == NodeKind::result_unit ||
           kind == NodeKind::result_range;
}

struct NodeRole {
    NodeKind kind = NodeKind::method;
    std::uint8_t detail = 0;
    std::uint16_t field = 0;  ///< index in the skill's parameters or results

    bool operator==(const NodeRole&) const = default;
};

/// A node of a layout that a skill uses.
struct UsedNode {
    std::size_t index = 0;  ///< index in the layout
    NodeRole node_role;
};

/// Assigns a skill's description to the nodes that it uses, in the order of the layout.
/// \param declared what the type declares for an instance. Fields that it declares as Optional may
///                 be missing: results, and parameters that no client must give. Empty: none may be
///                 missing
/// Errors: not_found, naming every other field that the layout lacks.
Result<std::vector<UsedNode>> assignNodeRoles(const SkillLayout& layout,
                                              const skill::SkillDescription& description,
                                              const SkillLayout& declared = {});

}  // namespace metier::opcua_skill
