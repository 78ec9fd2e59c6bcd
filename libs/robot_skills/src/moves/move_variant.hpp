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
    PathDeviationMeter::Path path;
    MoveEnd end;
    MovePlan<Parameters> plan;
};
using CartesianMoveVariant = MoveVariant<CartesianMoveParameters>;
using PathMoveVariant = MoveVariant<PathMoveParameters>;
using JointMoveVariant = MoveVariant<JointMoveParameters>;

// The moves. `model` must outlive them.
CartesianMoveVariant cartesianPtp(const motion::RobotModel& model);
CartesianMoveVariant cartesianLinear(const motion::RobotModel& model);
PathMoveVariant cartesianPath(const motion::RobotModel& model);
JointMoveVariant jointPtp(const motion::RobotModel& model);
JointMoveVariant jointLinear(const motion::RobotModel& model);

/// For a skill of that name that moves an arm.
skill::SkillDescription describeMove(std::string name, std::string description);

}  // namespace metier::robot_skills
