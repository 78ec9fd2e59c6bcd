#pragma once

#include <functional>
#include <memory>
#include <utility>

#include "conversions.hpp"
#include "metier/skill/typed_skill.hpp"
#include "moves/arm_skill.hpp"
#include "moves/arm_work.hpp"
#include "moves/move_variant.hpp"
#include "moves/timetable.hpp"

namespace metier::robot_skills {

/// Makes the execution of a planned motion; nothing moves.
/// Errors: why this arm cannot do it.
template <typename Parameters>
using MakeWork = std::function<Result<std::unique_ptr<skill::ExecutionWork>>(
    const motion::Trajectory&, const Parameters&)>;

/// Makes the function for the distance of the tool frame of `trajectory` between two joint
/// positions.
ToolDistance toolDistance(const motion::Trajectory& trajectory);

/// Makes the answer of Check from a plan.
skill::CheckReport reportOf(const motion::Planned<motion::Trajectory>& plan);

/// A move that metier plans at Start. Start refuses a motion that cannot be run to its end; the
/// work made for the plan executes it.
template <typename Parameters, typename Results = MoveResults>
class MoveSkill final : public skill::TypedSkill<Parameters, Results> {
public:
    struct Setup {
        device::Arm& arm;
        const motion::RobotModel& model;
        const Clock& clock;
        MakeWork<Parameters> make_work;
    };

    MoveSkill(Setup setup, MoveVariant<Parameters> variant, skill::FieldList<Results> results)
        : skill::TypedSkill<Parameters, Results>(std::move(variant.description),
                                                 std::move(variant.fields), std::move(results)),
          setup_(std::move(setup)),
          plan_(std::move(variant.plan)) {}

    Result<void> reset() override { return resetArm(setup_.arm); }

protected:
    Result<std::unique_ptr<skill::ExecutionWork>> plan(const Parameters& parameters) override {
        METIER_TRY(checkCanStart(parameters));
        auto trajectory = planFromHere(parameters);
        if (!trajectory) {
            return fail(std::move(trajectory.error().error));
        }
        return setup_.make_work(*trajectory, parameters);
    }

    Result<skill::CheckReport> assess(const Parameters& parameters) override {
        METIER_TRY(checkCanStart(parameters));
        const auto trajectory = planFromHere(parameters);
        if (trajectory) {
            METIER_TRY(setup_.make_work(*trajectory, parameters));
        }
        return reportOf(trajectory);
    }

private:
    Result<void> checkCanStart(const Parameters& parameters) const {
        auto ready = checkReady(setup_.arm);
        return ready ? checkStartTime(parameters.start_time, setup_.clock) : ready;
    }

    motion::Planned<motion::Trajectory> planFromHere(const Parameters& parameters) const {
        const auto start = toVector(setup_.arm.state().commanded_position);
        return plan_(setup_.model, start, parameters);
    }

    Setup setup_;
    MovePlan<Parameters> plan_;
};

/// Errors: invalid_argument if arm and model differ in their number of axes.
template <typename Parameters>
Result<std::unique_ptr<skill::Skill>> makeMove(typename MoveSkill<Parameters>::Setup setup,
                                               MoveVariant<Parameters> variant) {
    METIER_TRY(checkSameAxes(setup.arm, setup.model));
    return std::make_unique<MoveSkill<Parameters>>(std::move(setup), std::move(variant),
                                                   moveResultFields());
}

}  // namespace metier::robot_skills
