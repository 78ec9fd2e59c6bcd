#include "metier/robot_skills/move_skills.hpp"

#include <fmt/format.h>

#include <functional>
#include <utility>

#include "arm_body.hpp"
#include "arm_skill.hpp"
#include "conversions.hpp"
#include "metier/robot_skills/move_parameters.hpp"
#include "metier/robot_skills/move_planning.hpp"
#include "metier/skill/typed_skill.hpp"
#include "move_source.hpp"

namespace metier::robot_skills {

using motion::JointVector;
using motion::RobotModel;
using motion::Trajectory;
using Path = PathDeviationMeter::Path;

namespace {

template <typename Parameters>
using Plan = std::function<motion::Planned<Trajectory>(const RobotModel&, const JointVector&,
                                                       const Parameters&)>;

// Of the joint path that Check shows.
constexpr std::size_t kPreviewPoints = 50;

/// What makes one move different from the others.
template <typename Parameters>
struct Kind {
    skill::SkillDescription description;
    skill::FieldList<Parameters> fields;
    Path path;
    Plan<Parameters> plan;
};

ArmBody::ToolDistance toolDistance(const Trajectory& trajectory) {
    return [trajectory](const device::JointArray& a, const device::JointArray& b) {
        return geometry::distanceBetween(trajectory.toolPose(toVector(a)),
                                         trajectory.toolPose(toVector(b)));
    };
}

skill::CheckReport reportOf(const motion::Feasibility& feasibility) {
    skill::CheckReport report;
    if (feasibility.refusal) {
        report.possible = false;
        report.reason = feasibility.refusal->error.message;
        report.first_failing_fraction = feasibility.refusal->fraction;
        return report;
    }
    report.planned_duration = feasibility.duration.count();
    for (const auto& joints : feasibility.preview) {
        report.joint_path.emplace_back(joints.begin(), joints.end());
    }
    return report;
}

template <typename Parameters>
class MoveSkill final : public skill::TypedSkill<Parameters, MoveResults> {
public:
    MoveSkill(device::Arm& arm, const RobotModel& model, Kind<Parameters> kind)
        : skill::TypedSkill<Parameters, MoveResults>(std::move(kind.description),
                                                     std::move(kind.fields), moveResultFields()),
          arm_(arm),
          model_(model),
          path_(kind.path),
          plan_(std::move(kind.plan)) {}

    Result<void> reset() override { return arm_.resetFault(); }

protected:
    Result<std::unique_ptr<skill::Body>> plan(const Parameters& parameters) override {
        if (auto ready = checkReady(arm_); !ready) {
            return fail(std::move(ready.error()));
        }
        const auto start = toVector(arm_.state().commanded_position);
        auto trajectory = plan_(model_, start, parameters);
        if (!trajectory) {
            return fail(std::move(trajectory.error().error));
        }
        auto source = std::make_shared<MoveSource>(arm_.info(), *trajectory, path_);
        return std::make_unique<ArmBody>(arm_, std::move(source), toolDistance(*trajectory));
    }

    Result<skill::CheckReport> assess(const Parameters& parameters) override {
        if (auto ready = checkReady(arm_); !ready) {
            return fail(std::move(ready.error()));
        }
        const auto start = toVector(arm_.state().commanded_position);
        return reportOf(motion::assess(plan_(model_, start, parameters), kPreviewPoints));
    }

private:
    device::Arm& arm_;
    const RobotModel& model_;
    Path path_;
    Plan<Parameters> plan_;
};

skill::SkillDescription describe(std::string name, std::string description) {
    return {.name = name,
            .type = name + "Type",
            .description = std::move(description),
            .on_owner_loss = skill::OwnerLossAction::halt};
}

template <typename Parameters>
Result<std::unique_ptr<skill::Skill>> make(device::Arm& arm, const RobotModel& model,
                                           Kind<Parameters> kind) {
    if (auto checked = checkSameAxes(arm, model); !checked) {
        return fail(std::move(checked.error()));
    }
    return std::make_unique<MoveSkill<Parameters>>(arm, model, std::move(kind));
}

}  // namespace

Result<std::unique_ptr<skill::Skill>> makeCartesianPtpMoveSkill(device::Arm& arm,
                                                                const RobotModel& model) {
    return make<CartesianMoveParameters>(
        arm, model,
        {describe("CartesianPtpMoveSkill",
                  "Moves all axes together so that the tool frame reaches a pose"),
         cartesianMoveFields(model, MoveKind::ptp), Path::joint_line, planCartesianPtp});
}

Result<std::unique_ptr<skill::Skill>> makeCartesianLinearMoveSkill(device::Arm& arm,
                                                                   const RobotModel& model) {
    return make<CartesianMoveParameters>(
        arm, model,
        {describe("CartesianLinearMoveSkill", "Moves the tool frame on a straight line to a pose"),
         cartesianMoveFields(model, MoveKind::linear), Path::cartesian_line, planCartesianLinear});
}

Result<std::unique_ptr<skill::Skill>> makeJointPtpMoveSkill(device::Arm& arm,
                                                            const RobotModel& model) {
    return make<JointMoveParameters>(
        arm, model,
        {describe("JointPtpMoveSkill", "Moves all axes together to a joint position"),
         jointMoveFields(model, MoveKind::ptp), Path::joint_line, planJointPtp});
}

Result<std::unique_ptr<skill::Skill>> makeJointLinearMoveSkill(device::Arm& arm,
                                                               const RobotModel& model) {
    return make<JointMoveParameters>(
        arm, model,
        {describe("JointLinearMoveSkill",
                  "Moves the tool frame on a straight line to where a joint position puts it"),
         jointMoveFields(model, MoveKind::linear), Path::cartesian_line, planJointLinear});
}

}  // namespace metier::robot_skills
