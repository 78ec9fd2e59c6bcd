#pragma once

#include <memory>
#include <vector>

#include "metier/base/clock.hpp"
#include "metier/device/arm.hpp"
#include "metier/device/force_torque_sensor.hpp"
#include "metier/device/motion_planner.hpp"
#include "metier/motion/robot_model.hpp"
#include "metier/robot_skills/position_stream_skill.hpp"
#include "metier/robot_skills/stopping_report.hpp"
#include "metier/skill/resource.hpp"
#include "metier/skill/skill.hpp"

namespace metier::robot_skills {

/// All skills that an arm can have. A server publishes those that it wants.
struct ArmSkills {
    /// Put it into the ProgramOptions of every skill of this arm: they exclude each other.
    std::shared_ptr<skill::Resource> resource;
    /// CartesianPtp-, CartesianLinear-, JointPtp-, JointLinearMoveSkill;
    /// CartesianLinearForceMoveSkill, if the arm has a planner or a force sensor;
    /// CartesianPathMoveSkill. Hand each to a Program.
    std::vector<std::unique_ptr<skill::Skill>> moves;
    /// PositionStreamSkill.
    std::unique_ptr<skill::Skill> position_stream;
    /// Timing of the set-points of position_stream; shared with the skill.
    std::shared_ptr<const StreamReport> stream_report;
    /// Stopping time and way of the moves; shared with them.
    std::shared_ptr<const StoppingReport> stopping_report;
};

/// Interfaces of an arm; all must outlive its skills.
struct ArmDevices {
    /// The arm that moves.
    device::Arm& arm;
    /// Runs the moves that it can run exactly as asked; metier plans all others and sends
    /// set-points. Null: the controller has no planner.
    device::MotionPlanner* planner = nullptr;
    /// Ends the force moves that metier plans; null: none. A force move that the planner runs is
    /// ended by the controller's own force condition, which is nearer to the arm.
    device::ForceTorqueSensor* sensor = nullptr;
};

/// Makes the skills of an arm. Nothing moves, and the arm need not be connected.
/// \param model  must outlive the skills
/// \param clock  must outlive the skills; its wall clock counts for StartTime
/// \param stream settings of the position stream; its report must not be null
/// Errors: invalid_argument if arm and model differ in their number of axes.
Result<ArmSkills> makeArmSkills(const ArmDevices& devices, const motion::RobotModel& model,
                                const Clock& clock, const PositionStreamOptions& stream = {});

}  // namespace metier::robot_skills
