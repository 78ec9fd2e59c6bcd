#include "moves/force_move_skill.hpp"

#include <fmt/format.h>

#include <utility>

#include "metier/motion/force_limit.hpp"
#include "moves/controller_planned_motion.hpp"
#include "moves/controller_planned_work.hpp"
#include "moves/force_axes.hpp"
#include "moves/force_report.hpp"
#include "moves/move_skill.hpp"
#include "moves/sensor_failure.hpp"
#include "moves/streamed_move.hpp"

namespace metier::robot_skills {

using device::MotionOutcome;
using device::SafetyState;
using motion::RobotModel;
using motion::Trajectory;
using Path = PathDeviationMeter::Path;
using ForceSkill = MoveSkill<ForceMoveParameters, ForceMoveResults>;

namespace {

Eigen::Vector3d toEigen(const std::array<double, 3>& values) noexcept {
    return {values[0], values[1], values[2]};
}

Result<std::unique_ptr<skill::Skill>> makeForceSkill(ForceSkill::Setup setup) {
    METIER_TRY(checkSameAxes(setup.arm, setup.model));
    MoveVariant<ForceMoveParameters> variant{
        describeMove("CartesianLinearForceMoveSkill",
                     "Moves the tool frame on a straight line until it reaches a pose or a force"),
        forceMoveFields(setup.model), Path::cartesian_line, MoveEnd::pose, planCartesianLinear};
    return std::make_unique<ForceSkill>(std::move(setup), std::move(variant),
                                        forceMoveResultFields());
}

// ---- by the controller --------------------------------------------------------------------------

/// \param results their joint positions give the orientation of the flange
MetForce metForce(const RobotModel& model, const MoveResults& results,
                  const MotionOutcome& outcome) {
    const auto joints = motion::JointVector::from(results.reached_joint_position);
    const auto rotation = model.kinematics().forward(*joints).rotation;
    return {{rotation * toEigen(outcome.force), rotation * toEigen(outcome.torque)},
            rotation.toRotationMatrix().cwiseAbs() * toEigen(outcome.largest_force),
            outcome.end == MotionOutcome::End::force};
}

// ---- by a sensor --------------------------------------------------------------------------------

/// Watches a sensor at the flange in the axes of the base frame.
class SensorWatch final : public ContactWatch {
public:
    SensorWatch(const FeelingArm& arm, const ForceMoveParameters& parameters,
                const motion::ForceLimit& limit)
        : arm_(arm), parameters_(parameters), limit_(limit), failure_(arm.sensor) {}

    bool mustEnd(const device::ArmState& state) noexcept override {
        const auto sample = arm_.sensor.sample();
        if (sample.health != SafetyState::normal) {
            failure_.keep(sample.health);
            return true;
        }
        const auto rotation = arm_.model.kinematics().forward(toVector(state.position)).rotation;
        met_.contact = {rotation * toEigen(sample.force), rotation * toEigen(sample.torque)};
        met_.largest = met_.largest.cwiseMax(met_.contact.force.cwiseAbs());
        excess_ = limit_.check(met_.contact);
        met_.exceeded = excess_.has_value();
        return met_.exceeded;
    }

    void tell(const skill::ExecutionHandle& tell, const MoveResults& results) override {
        const bool broken =
            excess_ && excess_->quantity == motion::ForceExcess::Quantity::not_finite;
        if (failure_.kept() || broken) {
            tell.fail(skill::Reason::error,
                      fmt::format("{} failed during the motion: {}", arm_.sensor.name(),
                                  broken ? "its force is not finite" : failure_.text()));
            return;
        }
        tellForceMove(tell, parameters_, results, met_);
    }

private:
    FeelingArm arm_;
    ForceMoveParameters parameters_;
    motion::ForceLimit limit_;
    std::optional<motion::ForceExcess> excess_;
    SensorFailure failure_;
    MetForce met_;
};

Result<std::unique_ptr<skill::ExecutionWork>> feelingWork(const FeelingArm& arm,
                                                          const Trajectory& trajectory,
                                                          const ForceMoveParameters& parameters) {
    if (arm.sensor.sample().health != SafetyState::normal) {
        return fail(Errc::device_fault,
                    fmt::format("{}: {}", arm.sensor.name(), arm.sensor.safety().text));
    }
    const auto& max = parameters.max_force;
    METIER_ASSIGN(auto limit,
                  motion::ForceLimit::create({0.0, 0.0, {max.x, max.y, max.z, 0.0, 0.0, 0.0}},
                                             motion::Seconds(arm.arm.info().cycleSeconds())));
    return makeStreamedWork(
        {arm.arm, arm.model, arm.clock, arm.stopping},
        {trajectory, Path::cartesian_line, parameters.start_time, parameters.stop_time,
         std::make_unique<SensorWatch>(arm, parameters, limit)});
}

// ---- by either --------------------------------------------------------------------------------

/// Makes the request to the controller.
/// Errors: not_supported, where it cannot do exactly this.
Result<device::ControllerPlannedMotion> plannedForceMotion(const RobotModel& model,
                                                           const Trajectory& trajectory,
                                                           const ForceMoveParameters& parameters) {
    METIER_ASSIGN(auto motion,
                  controllerPlannedMotion({model, trajectory, Path::cartesian_line, parameters}));
    METIER_ASSIGN(auto condition, flangeCondition(model, trajectory, parameters.max_force));
    motion.until = condition;
    return motion;
}

Result<std::unique_ptr<skill::ExecutionWork>> plannedForceWork(
    const PlanningArm& arm, const Trajectory& trajectory, const ForceMoveParameters& parameters) {
    auto motion = plannedForceMotion(arm.model, trajectory, parameters);
    if (!motion && arm.sensor != nullptr) {
        return feelingWork({arm.arm, *arm.sensor, arm.model, arm.clock, arm.stopping}, trajectory,
                           parameters);
    }
    if (!motion) {
        return fail(std::move(motion.error()));
    }
    const auto tell = [&model = arm.model, parameters](const skill::ExecutionHandle& execution,
                                                       const MoveResults& results,
                                                       const MotionOutcome& outcome) {
        tellForceMove(execution, parameters, results, metForce(model, results, outcome));
    };
    auto move = std::make_shared<ControllerPlannedMove>(
        ControllerPlannedMove::Setup{arm, trajectory, Path::cartesian_line, MoveEnd::pose, tell});
    return std::make_unique<ControllerPlannedWork>(
        ControllerPlannedWork::Devices{arm.arm, arm.planner}, std::move(*motion), std::move(move),
        toolDistance(trajectory));
}

}  // namespace

Result<std::unique_ptr<skill::Skill>> makeControllerPlannedForceMoveSkill(const PlanningArm& arm) {
    return makeForceSkill({arm.arm, arm.model, arm.clock,
                           [arm](const Trajectory& trajectory, const ForceMoveParameters& given) {
                               return plannedForceWork(arm, trajectory, given);
                           }});
}

Result<std::unique_ptr<skill::Skill>> makeForceMoveSkill(const FeelingArm& arm) {
    return makeForceSkill({arm.arm, arm.model, arm.clock,
                           [arm](const Trajectory& trajectory, const ForceMoveParameters& given) {
                               return feelingWork(arm, trajectory, given);
                           }});
}

}  // namespace metier::robot_skills
