#pragma once

#include <functional>

#include "metier/robot_skills/move_parameters.hpp"
#include "metier/robot_skills/move_planning.hpp"
#include "metier/skill/field_list.hpp"
#include "metier/skill/skill.hpp"
#include "moves/path_deviation.hpp"

namespace metier::robot_skills {

template <typename Parameters>
using MovePlan = std::function<motion::Planned<motion::Trajectory>(
    const motion::RobotModel&, const motion::JointVector&, const Parameters&)>;

/// Conditions for the end of a motion besides the end of its path.
enum class MoveEnd : std::uint8_t {
    pose,    ///< the tool frame there, with whichever joints
    joints,  ///< just these joints
};

/// Differences between the moves, for any planner of the set-points.
template <typename Parameters>
struct MoveVariant {
    skill::SkillDescription description;
    skill::FieldList<Parameters> fields;
    PathDeviationMeter::Path path{};
    MoveEnd end{};
    MovePlan<Parameters> plan;
};
}  // namespace metier::robot_skills
