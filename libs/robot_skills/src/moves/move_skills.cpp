#include "moves/move_skills.hpp"

#include <utility>

#include "moves/move_skill.hpp"
#include "moves/streamed_move.hpp"

namespace metier::robot_skills {

using motion::Trajectory;

namespace {

/// A move whose set-points the arm's cycle thread takes from the plan.
template <typename Parameters>
Result<std::unique_ptr<skill::Skill>> makeStreamed(const StreamedArm& streamed,
                                                   MoveVariant<Parameters> variant) {
    const auto make_work =
        [streamed, path = variant.path](
            const Trajectory& trajectory,
            const Parameters& parameters) -> Result<std::unique_ptr<skill::ExecutionWork>> {
        return makeStreamedWork(streamed,
                                {trajectory, path, parameters.start_time, parameters.stop_time});
    };
    return makeMove<Parameters>({streamed.arm, streamed.model, streamed.clock, make_work},
                                std::move(variant));
}

}  // namespace

Result<std::unique_ptr<skill::Skill>> makeCartesianPtpMoveSkill(const StreamedArm& arm) {
    return makeStreamed(arm, cartesianPtp(arm.model));
}

Result<std::unique_ptr<skill::Skill>> makeCartesianLinearMoveSkill(const StreamedArm& arm) {
    return makeStreamed(arm, cartesianLinear(arm.model));
}

Result<std::unique_ptr<skill::Skill>> makeJointPtpMoveSkill(const StreamedArm& arm) {
    return makeStreamed(arm, jointPtp(arm.model));
}

Result<std::unique_ptr<skill::Skill>> makeJointLinearMoveSkill(const StreamedArm& arm) {
    return makeStreamed(arm, jointLinear(arm.model));
}

Result<std::unique_ptr<skill::Skill>> makeCartesianPathMoveSkill(const StreamedArm& arm) {
    return makeStreamed(arm, cartesianPath(arm.model));
}

}  // namespace metier::robot_skills
