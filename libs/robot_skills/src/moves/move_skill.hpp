#pragma once

#include <functional>
#include <memory>
#include <optional>
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

/// Where the arm of this server stands when a move begins; none: where it stands now.
/// Errors: invalid_argument (another number of axes, a value that is not finite, an unknown place).
Result<std::optional<motion::JointVector>> startIn(const skill::ArmPositions& starts,
                                                   const MovedArm& arm);

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
        return report(planFromHere(parameters), parameters);
    }

    void assessFrom(const skill::ArmPositions& starts, const Parameters& parameters,
                    skill::CheckDone done) override {
        done(startIn(starts, arm_).and_then([&](const auto& start) {
            return start ? assessFrom(*start, parameters) : assess(parameters);
        }));
    }

private:
    /// An arm that will have been moved until then need neither stand nor be ready now.
    Result<skill::CheckReport> assessFrom(const motion::JointVector& start,
                                          const Parameters& parameters) const {
        METIER_TRY(checkStartTime(parameters.start_time, arm_.clock));
        return report(plan_(arm_.model, start, parameters), parameters);
    }

    Result<void> checkCanStart(const Parameters& parameters) const {
        METIER_TRY(checkReady(arm_.arm));
        return checkStartTime(parameters.start_time, arm_.clock);
    }

    Result<skill::CheckReport> report(const motion::Planned<motion::Trajectory>& trajectory,
                                      const Parameters& parameters) const {
        if (trajectory) {
            METIER_TRY(make_work_(*trajectory, parameters));
        }
        return reportOf(trajectory);
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
