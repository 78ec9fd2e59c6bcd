#include "metier/robot_skills/arm_skills.hpp"

#include "metier/robot_skills/move_skills.hpp"

namespace metier::robot_skills {

Result<ArmSkills> makeArmSkills(device::Arm& arm, const motion::RobotModel& model,
                                const Clock& clock, const PositionStreamOptions& stream_options) {
    ArmSkills skills;
    skills.resource = std::make_shared<skill::Resource>("arm " + arm.info().name);
    for (auto* make : {makeCartesianPtpMoveSkill, makeCartesianLinearMoveSkill,
                       makeJointPtpMoveSkill, makeJointLinearMoveSkill}) {
        auto move = make(arm, model);
        if (!move) {
            return fail(std::move(move.error()));
        }
        skills.moves.push_back(std::move(*move));
    }
    auto stream = makePositionStreamSkill(arm, model, clock, stream_options);
    if (!stream) {
        return fail(std::move(stream.error()));
    }
    skills.position_stream = std::move(*stream);
    return skills;
}

}  // namespace metier::robot_skills
