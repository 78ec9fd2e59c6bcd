#include "moves/controller_planned_move_skills.hpp"

#include <utility>

#include "moves/controller_planned_motion.hpp"
#include "moves/controller_planned_work.hpp"
#include "moves/move_skill.hpp"
#include "moves/streamed_move.hpp"

namespace metier::robot_skills {

using motion::Trajectory;
using Skills = std::vector<std::unique_ptr<skill::Skill>>;

namespace {

/// The controller's motion where it is what was asked, else metier's own set-points.
template <typename Parameters>
Result<std::unique_ptr<skill::Skill>> makePlanned(const PlanningArm& arm,
                                                  MoveVariant<Parameters> variant) {
    const auto make_work =
        [arm, path = variant.path, end = variant.end](
            const Trajectory& trajectory,
            const Parameters& parameters) -> Result<std::unique_ptr<skill::ExecutionWork>> {
        auto motion = controllerPlannedMotion({arm.model, trajectory, path, parameters});
        if (!motion) {
            return makeStreamedWork(
                {arm.arm, arm.model, arm.clock, arm.stopping},
                {trajectory, path, parameters.start_time, parameters.stop_time});
        }
        auto move = std::make_shared<ControllerPlannedMove>(
            ControllerPlannedMove::Setup{arm, trajectory, path, end, tellMoveDone});
        return std::make_unique<ControllerPlannedWork>(
            ControllerPlannedWork::Devices{arm.arm, arm.planner}, std::move(*motion),
            std::move(move), toolDistance(trajectory));
    };
    return makeMove<Parameters>({arm.arm, arm.model, arm.clock, make_work}, std::move(variant));
}

/// Errors: that of the first one that could not be made.
Result<Skills> all(std::vector<Result<std::unique_ptr<skill::Skill>>> made) {
    Skills skills;
    for (auto& one : made) {
        if (!one) {
            return fail(std::move(one.error()));
        }
        skills.push_back(std::move(*one));
    }
    return skills;
}

}  // namespace

Result<Skills> makeControllerPlannedMoveSkills(const PlanningArm& arm) {
    std::vector<Result<std::unique_ptr<skill::Skill>>> made;
    made.push_back(makePlanned(arm, cartesianPtp(arm.model)));
    made.push_back(makePlanned(arm, cartesianLinear(arm.model)));
    made.push_back(makePlanned(arm, jointPtp(arm.model)));
    made.push_back(makePlanned(arm, jointLinear(arm.model)));
    return all(std::move(made));
}

}  // namespace metier::robot_skills
