#pragma once

#include <memory>
#include <vector>

#include "metier/base/clock.hpp"
#include "metier/device/arm.hpp"
#include "metier/motion/robot_model.hpp"
#include "metier/robot_skills/position_stream_skill.hpp"
#include "metier/skill/resource.hpp"
#include "metier/skill/skill.hpp"

namespace metier::robot_skills {

/// All skills that an arm can have. A server offers those it wants to.
struct ArmSkills {
    /// For the ProgramOptions of every skill of this arm: they exclude each other.
    std::shared_ptr<skill::Resource> resource;
    /// CartesianPtp-, CartesianLinear-, JointPtp-, JointLinearMoveSkill.
    std::vector<std::unique_ptr<skill::Skill>> moves;
    std::unique_ptr<skill::Skill> position_stream;
};

/// \param arm, model, clock must outlive the skills
/// Errors: invalid_argument if arm and model differ in their number of axes.
Result<ArmSkills> makeArmSkills(device::Arm& arm, const motion::RobotModel& model,
                                const Clock& clock, const PositionStreamOptions& stream = {});

}  // namespace metier::robot_skills
