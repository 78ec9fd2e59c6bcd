#include "moves/move_variant.hpp"

#include <utility>

namespace metier::robot_skills {

using motion::RobotModel;
using Path = PathDeviationMeter::Path;

skill::SkillDescription describeMove(std::string name, std::string description) {
    return {.name = name,
            .type = name + "Type",
            .description = std::move(description),
            .on_owner_loss = skill::OwnerLossAction::halt};
}

CartesianMoveVariant cartesianPtp(const RobotModel& model) {
    return {describeMove("CartesianPtpMoveSkill",
                         "Moves all axes together so that the tool frame reaches a pose"),
            cartesianMoveFields(model, MoveKind::ptp), Path::joint_line, MoveEnd::joints,
            planCartesianPtp};
}

CartesianMoveVariant cartesianLinear(const RobotModel& model) {
    return {describeMove("CartesianLinearMoveSkill",
                         "Moves the tool frame on a straight line to a pose"),
            cartesianMoveFields(model, MoveKind::linear), Path::cartesian_line, MoveEnd::pose,
            planCartesianLinear};
}

PathMoveVariant cartesianPath(const RobotModel& model) {
    return {describeMove("CartesianPathMoveSkill",
                         "Moves the tool frame on straight lines through poses, corners rounded"),
            pathMoveFields(model), Path::cartesian_line, MoveEnd::pose, planCartesianPath};
}

JointMoveVariant jointPtp(const RobotModel& model) {
    return {describeMove("JointPtpMoveSkill", "Moves all axes together to a joint position"),
            jointMoveFields(model, MoveKind::ptp), Path::joint_line, MoveEnd::joints, planJointPtp};
}

JointMoveVariant jointLinear(const RobotModel& model) {
    return {
        describeMove("JointLinearMoveSkill",
                     "Moves the tool frame on a straight line to where a joint position puts it"),
        jointMoveFields(model, MoveKind::linear), Path::cartesian_line, MoveEnd::joints,
        planJointLinear};
}

}  // namespace metier::robot_skills
