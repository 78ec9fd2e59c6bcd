#include "moves/force_move_skill.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "metier/base/numbers.hpp"
#include "metier/motion/force_limit.hpp"
#include "moves/controller_planned_motion.hpp"
#include "moves/controller_planned_work.hpp"
#include "moves/move_skill.hpp"
#include "moves/move_source.hpp"
#include "moves/sensor_failure.hpp"

namespace metier::robot_skills {

using device::MotionOutcome;
using device::SafetyState;
using motion::RobotModel;
using motion::Trajectory;
using Path = PathDeviationMeter::Path;
using Work = Result<std::unique_ptr<skill::ExecutionWork>>;

namespace {

Eigen::Vector3d toEigen(const std::array<double, 3>& values) noexcept {
    return {values[0], values[1], values[2]};
}

skill::Vector3 toVector3(const Eigen::Vector3d& vector) {
    return {vector.x(), vector.y(), vector.z()};
}

std::string textOf(const skill::Vector3& force) {
    return fmt::format("[{:.1f}, {:.1f}, {:.1f}] N", force.x, force.y, force.z);
}

/// Forces that a force move measured, in the base frame.
struct MetForce {
    motion::Wrench contact;                             ///< at the end
    Eigen::Vector3d largest = Eigen::Vector3d::Zero();  ///< along each axis, without sign [N]
    bool exceeded = false;                              ///< ended the motion
};

/// Reports the end of a force move: finished, or failed if a force over its limit is an error.
void tellForceMove(const skill::ExecutionHandle& tell, const ForceMoveParameters& parameters,
                   const MoveResults& results, const MetForce& met) {
    ForceMoveResults all;
    static_cast<MoveResults&>(all) = results;
    all.contact_force = toVector3(met.contact.force);
    all.contact_torque = toVector3(met.contact.torque);
    all.forces_max = toVector3(met.largest);
    if (met.exceeded) {
        all.forces_exceeded = all.contact_force;
    }
    if (met.exceeded && parameters.halt_on_force) {
        tell.fail(skill::Reason::force_exceeded,
                  fmt::format("the contact force {} in the base frame is over its limit {}",
                              textOf(all.contact_force), textOf(parameters.max_force)));
        return;
    }
    tell.finish(forceMoveResultFields().write(all));
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

constexpr int kForceSamples = 20;
constexpr double kSameAxis = 1.0 * kDegree;

Eigen::Matrix3d baseFromFlange(const RobotModel& model, const motion::JointVector& joints) {
    return model.kinematics().forward(joints).rotation.toRotationMatrix();
}

/// The angle between a base axis and a flange axis, as lines.
double angleBetween(const Eigen::Matrix3d& base_from_flange, int base, int flange) {
    return std::acos(std::min(1.0, std::abs(base_from_flange(base, flange))));
}

int nearestFlangeAxis(const Eigen::Matrix3d& base_from_flange, int base) {
    Eigen::Index nearest = 0;
    base_from_flange.row(base).cwiseAbs().maxCoeff(&nearest);
    return static_cast<int>(nearest);
}

/// Limits along the base frame's axes as limits along the flange's, where these are the same for
/// the whole motion.
/// Errors: not_supported with the angle between them.
Result<device::ForceCondition> flangeCondition(const RobotModel& model,
                                               const Trajectory& trajectory,
                                               const skill::Vector3& max_force) {
    const std::array limits{max_force.x, max_force.y, max_force.z};
    const auto at_start = baseFromFlange(model, trajectory.start());
    device::ForceCondition condition;
    for (int base = 0; base < 3; ++base) {
        const double limit = limits[static_cast<std::size_t>(base)];
        if (limit == 0.0) {
            continue;
        }
        const int flange = nearestFlangeAxis(at_start, base);
        for (int i = 0; i <= kForceSamples; ++i) {
            const double fraction = static_cast<double>(i) / kForceSamples;
            const auto there = baseFromFlange(model, trajectory.positionAt(fraction));
            if (const double angle = angleBetween(there, base, flange); angle > kSameAxis) {
                return fail(
                    Errc::not_supported,
                    fmt::format("MaxForce along {} of the base frame: at {:.0f} % of the "
                                "path the nearest axis of the flange is {:.1f} deg from "
                                "it, limit {:.0f} deg; the controller watches the "
                                "flange's axes only",
                                "xyz"[base], 100 * fraction, angle / kDegree, kSameAxis / kDegree));
            }
        }
        condition.force[static_cast<std::size_t>(flange)] = limit;
    }
    return condition;
}

// ---- by a sensor --------------------------------------------------------------------------------

/// Watches a sensor at the flange in the axes of the base frame.
class SensorWatch final : public ContactWatch {
public:
    SensorWatch(const MovedArm& arm, const ForceMoveParameters& parameters,
                const motion::ForceLimit& limit)
        : model_(arm.model),
          sensor_(*arm.sensor),
          parameters_(parameters),
          limit_(limit),
          failure_(sensor_) {}

    bool mustEnd(const device::ArmState& state) noexcept override {
        const auto sample = sensor_.sample();
        if (sample.health != SafetyState::normal) {
            failure_.keep(sample.health);
            return true;
        }
        const auto rotation = model_.kinematics().forward(toVector(state.position)).rotation;
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
                      fmt::format("{} failed during the motion: {}", sensor_.name(),
                                  broken ? "its force is not finite" : failure_.text()));
            return;
        }
        tellForceMove(tell, parameters_, results, met_);
    }

private:
    const RobotModel& model_;
    device::ForceTorqueSensor& sensor_;
    ForceMoveParameters parameters_;
    motion::ForceLimit limit_;
    std::optional<motion::ForceExcess> excess_;
    SensorFailure failure_;
    MetForce met_;
};

Work feelingWork(const MovedArm& arm, const Trajectory& trajectory,
                 const ForceMoveParameters& parameters) {
    if (arm.sensor->sample().health != SafetyState::normal) {
        return fail(Errc::device_fault,
                    fmt::format("{}: {}", arm.sensor->name(), arm.sensor->safety().text));
    }
    const auto& max = parameters.max_force;
    METIER_ASSIGN(auto limit,
                  motion::ForceLimit::create({0.0, 0.0, {max.x, max.y, max.z, 0.0, 0.0, 0.0}},
                                             motion::Seconds(arm.arm.info().cycleSeconds())));
    return makeStreamedWork(arm, {trajectory, Path::cartesian_line, parameters,
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

Work forceWork(const MovedArm& arm, const Trajectory& trajectory,
               const ForceMoveParameters& parameters) {
    if (arm.planner == nullptr) {
        return feelingWork(arm, trajectory, parameters);
    }
    auto motion = plannedForceMotion(arm.model, trajectory, parameters);
    if (!motion && arm.sensor != nullptr) {
        return feelingWork(arm, trajectory, parameters);
    }
    if (!motion) {
        return fail(std::move(motion.error()));
    }
    const auto tell = [&model = arm.model, parameters](const skill::ExecutionHandle& execution,
                                                       const MoveResults& results,
                                                       const MotionOutcome& outcome) {
        tellForceMove(execution, parameters, results, metForce(model, results, outcome));
    };
    return std::make_unique<ControllerPlannedWork>(
        *arm.planner, std::move(*motion),
        ControllerPlannedMove::Setup{arm, trajectory, Path::cartesian_line, MoveEnd::pose, tell});
}

}  // namespace

std::unique_ptr<skill::Skill> makeForceMoveSkill(const MovedArm& arm) {
    MoveVariant<ForceMoveParameters> variant{
        describeMove("CartesianLinearForceMoveSkill",
                     "Moves the tool frame on a straight line until it reaches a pose or a force"),
        forceMoveFields(arm.model), Path::cartesian_line, MoveEnd::pose, planCartesianLinear};
    return std::make_unique<MoveSkill<ForceMoveParameters, ForceMoveResults>>(
        arm, std::move(variant), forceMoveResultFields(),
        [arm](const Trajectory& trajectory, const ForceMoveParameters& given) {
            return forceWork(arm, trajectory, given);
        });
}

}  // namespace metier::robot_skills
