#include "metier/robot_skills/arm_skills.hpp"

#include <utility>

#include "moves/controller_planned_move_skills.hpp"
#include "moves/force_move_skill.hpp"
#include "moves/move_skills.hpp"

namespace metier::robot_skills {

namespace {

using MadeSkill = Result<std::unique_ptr<skill::Skill>>;
using Skills = std::vector<std::unique_ptr<skill::Skill>>;

/// `skills` and one more.
Result<Skills> with(Skills skills, MadeSkill made) {
    if (!made) {
        return fail(std::move(made.error()));
    }
    skills.push_back(std::move(*made));
    return skills;
}

Result<Skills> streamedMoves(const StreamedArm& arm) {
    Result<Skills> moves;
    for (auto* make : {makeCartesianPtpMoveSkill, makeCartesianLinearMoveSkill,
                       makeJointPtpMoveSkill, makeJointLinearMoveSkill}) {
        if (moves) {
            moves = with(std::move(*moves), make(arm));
        }
    }
    return moves;
}

Result<Skills> makeMoves(const ArmDevices& devices, const StreamedArm& streamed) {
    const auto& [arm, model, clock, stopping] = streamed;
    if (devices.planner == nullptr) {
        auto moves = streamedMoves(streamed);
        if (moves && devices.sensor != nullptr) {
            moves = with(std::move(*moves),
                         makeForceMoveSkill({arm, *devices.sensor, model, clock, stopping}));
        }
        return moves;
    }
    const PlanningArm planning{arm, *devices.planner, model, clock, devices.sensor, stopping};
    METIER_ASSIGN(auto moves, makeControllerPlannedMoveSkills(planning));
    return with(std::move(moves), makeControllerPlannedForceMoveSkill(planning));
}

}  // namespace

Result<ArmSkills> makeArmSkills(const ArmDevices& devices, const motion::RobotModel& model,
                                const Clock& clock, const PositionStreamOptions& stream) {
    ArmSkills skills;
    skills.resource = std::make_shared<skill::Resource>("arm " + devices.arm.info().name);
    const StreamedArm streamed{devices.arm, model, clock};
    auto moves = makeMoves(devices, streamed);
    if (moves) {
        moves = with(std::move(*moves), makeCartesianPathMoveSkill(streamed));
    }
    if (!moves) {
        return fail(std::move(moves.error()));
    }
    skills.moves = std::move(*moves);
    METIER_ASSIGN(auto position_stream, makePositionStreamSkill(devices.arm, model, clock, stream));
    skills.position_stream = std::move(position_stream);
    skills.stream_report = stream.report;
    skills.stopping_report = streamed.stopping;
    return skills;
}

Result<ArmSkills> makeArmSkills(device::Arm& arm, const motion::RobotModel& model,
                                const Clock& clock, const PositionStreamOptions& stream) {
    return makeArmSkills(ArmDevices{arm}, model, clock, stream);
}

}  // namespace metier::robot_skills
