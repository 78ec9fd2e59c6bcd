#include "metier/robot_skills/move_skills.hpp"

#include <utility>

#include "move_skill.hpp"
#include "move_source.hpp"
#include "source_body.hpp"

namespace metier::robot_skills {

using motion::RobotModel;
using motion::Trajectory;

namespace {

/// A move whose set-points the arm's cycle thread takes from the plan.
template <typename Parameters>
Result<std::unique_ptr<skill::Skill>> makeStreamed(device::Arm& arm, const RobotModel& model,
                                                   MoveVariant<Parameters> variant) {
    const auto make_body =
        [&arm, path = variant.path](
            const Trajectory& trajectory,
            const Parameters& /*parameters*/) -> Result<std::unique_ptr<skill::Body>> {
        auto source = std::make_shared<MoveSource>(arm.info(), trajectory, path);
        return std::make_unique<SourceBody>(arm, std::move(source), toolDistance(trajectory));
    };
    return makeMove<Parameters>({arm, model, make_body}, std::move(variant));
}

}  // namespace

Result<std::unique_ptr<skill::Skill>> makeCartesianPtpMoveSkill(device::Arm& arm,
                                                                const RobotModel& model) {
    return makeStreamed(arm, model, cartesianPtp(model));
}

Result<std::unique_ptr<skill::Skill>> makeCartesianLinearMoveSkill(device::Arm& arm,
                                                                   const RobotModel& model) {
    return makeStreamed(arm, model, cartesianLinear(model));
}

Result<std::unique_ptr<skill::Skill>> makeJointPtpMoveSkill(device::Arm& arm,
                                                            const RobotModel& model) {
    return makeStreamed(arm, model, jointPtp(model));
}

Result<std::unique_ptr<skill::Skill>> makeJointLinearMoveSkill(device::Arm& arm,
                                                               const RobotModel& model) {
    return makeStreamed(arm, model, jointLinear(model));
}

}  // namespace metier::robot_skills
