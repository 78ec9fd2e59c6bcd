#pragma once

#include <functional>
#include <memory>
#include <utility>

#include "conversions.hpp"
#include "metier/skill/typed_skill.hpp"
#include "moves/arm_skill.hpp"
#include "moves/move_skills.hpp"
#include "moves/move_variant.hpp"
#include "moves/timetable.hpp"

namespace metier::robot_skills {

/// Makes the execution of a planned motion; nothing moves.
/// Errors: why this arm cannot do it.
template <typename Parameters>
using MakeWork = std::function<Result<std::unique_ptr<skill::ExecutionWork>>(
    const motion::Trajectory&, const Parameters&)>;

/// For a skill of that name that moves an arm.
skill::SkillDescription describeMove(std::string name, std::string description);

/// Makes the answer of Check from a plan.
skill::CheckReport reportOf(const motion::Planned<motion::Trajectory>& plan);

/// A move that metier plans at Start. Start refuses a motion that cannot be run to its end; the
/// work made for the plan executes it.
template <typename Parameters, typename Results = MoveResults>
class MoveSkill final : public skill::TypedSkill<Parameters, Results> {
public:
    MoveSkill(MovedArm arm, MoveVariant<Parameters> variant, skill::FieldList<Results> results,
              MakeWork<Parameters> make_work)
        : skill::TypedSkill<Parameters, Results>(std::move(variant.description),
                                                 std::move(variant.fields), std::move(results)),
          arm_(std::move(arm)),
          plan_(std::move(variant.plan)),
          make_work_(std::move(make_work)) {}

    Result<void> reset() override { return resetArm(arm_.arm); }

protected:
    Result<std::unique_ptr<skill::ExecutionWork>> plan(const Parameters& parameters) override {
        METIER_TRY(checkCanStart(parameters));
        auto trajectory = planFromHere(parameters);
        if (!trajectory) {
            return fail(std::move(trajectory.error().error));
        }
        return make_work_(*trajectory, parameters);
    }

    Result<skill::CheckReport> assess(const Parameters& parameters) override {
        METIER_TRY(checkCanStart(parameters));
        const auto trajectory = planFromHere(parameters);
        if (trajectory) {
            METIER_TRY(make_work_(*trajectory, parameters));
        }
        return reportOf(trajectory);
    }

private:
    Result<void> checkCanStart(const Parameters& parameters) const {
        METIER_TRY(checkReady(arm_.arm));
        return checkStartTime(parameters.start_time, arm_.clock);
    }

    motion::Planned<motion::Trajectory> planFromHere(const Parameters& parameters) const {
        const auto start = toVector(arm_.arm.state().commanded_position);
        return plan_(arm_.model, start, parameters);
    }

    MovedArm arm_;
    MovePlan<Parameters> plan_;
    MakeWork<Parameters> make_work_;
};

}  // namespace metier::robot_skills
