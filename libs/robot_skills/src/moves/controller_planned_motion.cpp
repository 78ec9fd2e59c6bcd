#include "moves/controller_planned_motion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "conversions.hpp"
#include "metier/motion/frame.hpp"
#include "metier/motion/rotation.hpp"

namespace metier::robot_skills {

using device::ControllerPlannedMotion;
using motion::JointVector;
using motion::Pose;
using motion::RobotModel;
using motion::Trajectory;

namespace {

// Number of points at which a path is checked.
constexpr int kSamples = 50;
// The tool frame may be this far off its line [m].
constexpr double kStraight = 1e-4;
// An axis may end this far from where it is planned to [rad].
constexpr double kSameJoints = 1e-3;
// A line shorter than this is a rotation, which a controller's speed along the line does not bound
// [m].
constexpr double kShortLine = 1e-3;
// The fastest axis must be at least this fast, so that the controller's motion is seen as one
// [rad/s].
constexpr double kSlowest = 2e-3;

tl::unexpected<Error> notByController(std::string why) {
    return fail(Errc::not_supported, "the controller's own motion: " + std::move(why));
}

double fraction(int sample) noexcept {
    return static_cast<double>(sample) / kSamples;
}

/// Largest speed of an axis along the path.
struct AxisSpeed {
    double absolute = 0.0;  ///< [rad/s]
    double share = 0.0;     ///< share of the axis' limit
};

AxisSpeed fastestAxis(const ControllerPlannedRequest& request, double path_speed) {
    AxisSpeed fastest;
    auto before = request.trajectory.start();
    for (int i = 1; i <= kSamples; ++i) {
        const auto now = request.trajectory.positionAt(fraction(i));
        for (std::size_t axis = 0; axis < now.size(); ++axis) {
            const double speed = std::abs(now[axis] - before[axis]) * kSamples * path_speed;
            fastest.absolute = std::max(fastest.absolute, speed);
            fastest.share = std::max(fastest.share, speed / request.model.limits(axis).velocity);
        }
        before = now;
    }
    return fastest;
}

Result<void> checkTimes(const MoveParameters& parameters) {
    if (parameters.start_time) {
        return notByController("it begins at once, not at a StartTime");
    }
    if (parameters.duration) {
        return notByController("it takes as long as it takes, not a Duration");
    }
    if (parameters.stop_time.value_or(0.0) > 0.0) {
        return notByController("its stop is its own, not one of a StopTime");
    }
    return {};
}

/// The robot's own accelerations in the order of MaxAcceleration.
std::vector<double> ownAccelerations(const ControllerPlannedRequest& request) {
    if (request.path == PathDeviationMeter::Path::cartesian_line) {
        const auto& limits = request.model.cartesianLimits();
        const double linear = limits.acceleration;
        const double angular = limits.angular_acceleration;
        return {linear, linear, linear, angular, angular, angular};
    }
    std::vector<double> own;
    for (std::size_t axis = 0; axis < request.model.axisCount(); ++axis) {
        own.push_back(request.model.limits(axis).acceleration);
    }
    return own;
}

/// A controller brakes with the acceleration of its motion: a low one would make Halt slow.
Result<void> checkAcceleration(const ControllerPlannedRequest& request) {
    const auto& asked = request.parameters.max_acceleration;
    const auto own = ownAccelerations(request);
    for (std::size_t i = 0; i < std::min(asked.size(), own.size()); ++i) {
        if (asked[i] > 0.0 && asked[i] < own[i]) {
            return notByController(
                fmt::format("it would brake with MaxAcceleration, {}, where the robot can {}",
                            asked[i], own[i]));
        }
    }
    return {};
}

/// A controller's line keeps the elbow where it is.
Result<void> checkElbow(const RobotModel& model, const Trajectory& trajectory) {
    const auto& kinematics = model.kinematics();
    const auto end = trajectory.end();
    const auto kept = kinematics.solutionNear(kinematics.forward(end), end,
                                              kinematics.redundancyAngle(trajectory.start()));
    if (!kept.empty() && motion::maxDifference(kept, end) <= kSameJoints) {
        return {};
    }
    const double turned = std::abs(std::remainder(
        kinematics.redundancyAngle(end) - kinematics.redundancyAngle(trajectory.start()),
        2.0 * M_PI));
    return notByController(fmt::format("a line that turns the elbow {:.4f} rad", turned));
}

/// The tool frame when the flange is so far along its own straight line.
Pose toolOnFlangeLine(const Pose& from, const Pose& to, const Pose& flange_from_tool, double part) {
    const Pose flange{from.translation + part * (to.translation - from.translation),
                      motion::slerp(from.rotation, to.rotation, part)};
    return flange * flange_from_tool;
}

Result<void> checkSameLine(const RobotModel& model, const Trajectory& trajectory) {
    const auto from = model.kinematics().forward(trajectory.start());
    const auto to = model.kinematics().forward(trajectory.end());
    const Pose flange_from_tool = from.inverse() * trajectory.toolPose(trajectory.start());
    double worst = 0.0;
    for (int i = 1; i < kSamples; ++i) {
        const auto tool = toolOnFlangeLine(from, to, flange_from_tool, fraction(i));
        worst = std::max(worst, trajectory.deviation(tool).distance);
    }
    if (worst <= kStraight) {
        return {};
    }
    return notByController(
        fmt::format("the tool frame would be {:.4f} m off its line, limit {} m", worst, kStraight));
}

/// The line's speed is the plan's; its acceleration the robot's own.
void setLineLimits(const ControllerPlannedRequest& request, double path_speed,
                   ControllerPlannedMotion& motion) {
    const auto& own = request.model.cartesianLimits();
    const double length = request.trajectory.length();
    const double angle = request.trajectory.angle();
    motion.line_velocity = path_speed * length;
    motion.line_acceleration = own.acceleration * angle > own.angular_acceleration * length
                                   ? own.angular_acceleration * length / angle
                                   : own.acceleration;
}

Result<ControllerPlannedMotion> plannedLine(const ControllerPlannedRequest& request,
                                            double path_speed) {
    const auto& [model, trajectory, path, parameters] = request;
    if (trajectory.length() < kShortLine) {
        return notByController("its speed bounds no rotation");
    }
    METIER_TRY(checkElbow(model, trajectory));
    METIER_TRY(checkSameLine(model, trajectory));
    ControllerPlannedMotion motion;
    motion.path = ControllerPlannedMotion::Path::line;
    motion.target_flange = motion::toFrame(model.kinematics().forward(trajectory.end()));
    setLineLimits(request, path_speed, motion);
    return motion;
}

}  // namespace

double plannedPathSpeed(const Trajectory& trajectory) noexcept {
    const double clock_speed = trajectory.clockSpeed();
    double fastest = 0.0;
    for (int i = 0; i <= kSamples; ++i) {
        const double clock = fraction(i) * trajectory.clockEnd();
        fastest = std::max(fastest, trajectory.pathParameter({clock, clock_speed, 0.0}).velocity);
    }
    return fastest;
}

Result<ControllerPlannedMotion> controllerPlannedMotion(const ControllerPlannedRequest& request) {
    METIER_TRY(checkTimes(request.parameters));
    METIER_TRY(checkAcceleration(request));
    const double path_speed = plannedPathSpeed(request.trajectory);
    const auto fastest = fastestAxis(request, path_speed);
    // Without any way there is no speed.
    if (fastest.absolute > 0.0 && fastest.absolute < kSlowest) {
        return notByController(fmt::format(
            "{:.5f} rad/s is too slow to be distinguished from standstill", fastest.absolute));
    }
    Result<ControllerPlannedMotion> motion;
    if (request.path == PathDeviationMeter::Path::joint_line) {
        motion->velocity_share = fastest.share > 0.0 ? std::min(fastest.share, 1.0) : 1.0;
    } else {
        motion = plannedLine(request, path_speed);
    }
    if (motion) {
        motion->target_joints = toArray(request.trajectory.end());
    }
    return motion;
}

}  // namespace metier::robot_skills
