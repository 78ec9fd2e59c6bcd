#include "moves/move_skills.hpp"

#include <utility>

#include "moves/controller_planned_motion.hpp"
#include "moves/controller_planned_work.hpp"
#include "moves/force_move_skill.hpp"
#include "moves/move_skill.hpp"
#include "moves/move_source.hpp"

namespace metier::robot_skills {

using motion::Trajectory;
using Path = PathDeviationMeter::Path;

namespace {

/// A move that is run by the controller's motion where it is what was asked, else by metier's own
/// set-points.
template <typename Parameters>
std::unique_ptr<skill::Skill> makeMove(const MovedArm& arm, MoveVariant<Parameters> variant) {
    const auto make_work =
        [arm, path = variant.path, end = variant.end](
            const Trajectory& trajectory,
            const Parameters& parameters) -> Result<std::unique_ptr<skill::ExecutionWork>> {
        if (arm.planner != nullptr) {
            if (auto motion = controllerPlannedMotion({arm.model, trajectory, path, parameters})) {
                return std::make_unique<ControllerPlannedWork>(
                    *arm.planner, std::move(*motion),
                    ControllerPlannedMove::Setup{arm, trajectory, path, end, tellMoveDone});
            }
        }
        return makeStreamedWork(arm, {trajectory, path, parameters});
    };
    return std::make_unique<MoveSkill<Parameters>>(arm, std::move(variant), moveResultFields(),
                                                   make_work);
}

std::unique_ptr<skill::Skill> makePathMove(MovedArm arm) {
    arm.planner = nullptr;
    return makeMove<PathMoveParameters>(
        arm, {describeMove("CartesianPathMoveSkill",
                           "Moves the tool frame on straight lines through poses, corners rounded"),
              pathMoveFields(arm.model), Path::cartesian_line, MoveEnd::pose, planCartesianPath});
}

}  // namespace

std::vector<std::unique_ptr<skill::Skill>> makeMoveSkills(const MovedArm& arm) {
    const auto& model = arm.model;
    std::vector<std::unique_ptr<skill::Skill>> moves;
    moves.push_back(makeMove<CartesianMoveParameters>(
        arm, {describeMove("CartesianPtpMoveSkill",
                           "Moves all axes together so that the tool frame reaches a pose"),
              cartesianMoveFields(model, MoveKind::ptp), Path::joint_line, MoveEnd::joints,
              planCartesianPtp}));
    moves.push_back(makeMove<CartesianMoveParameters>(
        arm, {describeMove("CartesianLinearMoveSkill",
                           "Moves the tool frame on a straight line to a pose"),
              cartesianMoveFields(model, MoveKind::linear), Path::cartesian_line, MoveEnd::pose,
              planCartesianLinear}));
    moves.push_back(makeMove<JointMoveParameters>(
        arm,
        {describeMove("JointPtpMoveSkill", "Moves all axes together to a joint position"),
         jointMoveFields(model, MoveKind::ptp), Path::joint_line, MoveEnd::joints, planJointPtp}));
    moves.push_back(makeMove<JointMoveParameters>(
        arm,
        {describeMove("JointLinearMoveSkill",
                      "Moves the tool frame on a straight line to where a joint position puts it"),
         jointMoveFields(model, MoveKind::linear), Path::cartesian_line, MoveEnd::joints,
         planJointLinear}));
    if (arm.planner != nullptr || arm.sensor != nullptr) {
        moves.push_back(makeForceMoveSkill(arm));
    }
    moves.push_back(makePathMove(arm));
    return moves;
}

}  // namespace metier::robot_skills
