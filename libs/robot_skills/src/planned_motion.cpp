#include "planned_motion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "conversions.hpp"
#include "metier/geometry/frame.hpp"
#include "metier/geometry/rotation.hpp"

namespace metier::robot_skills {

using device::PlannedMotion;
using geometry::Pose;
using motion::JointVector;
using motion::RobotModel;
using motion::Trajectory;

namespace {

// Where a path is looked at.
constexpr int kSamples = 50;
// The tool frame may be this far off its line [m].
constexpr double kStraight = 1e-4;
// The elbow may end this far from where it began [rad].
constexpr double kSameElbow = 0.02;
// A line shorter than this is a rotation: its speed along the line says nothing [m].
constexpr double kShortLine = 1e-3;

double fraction(int sample) noexcept {
    return static_cast<double>(sample) / kSamples;
}

/// Largest speed and acceleration of the path parameter that the plan may use [1/s], [1/s2].
struct PathSpeed {
    double velocity = 0.0;
    double acceleration = 0.0;
};

PathSpeed pathSpeed(const Trajectory& trajectory) noexcept {
    const auto& limits = trajectory.clockLimits();
    PathSpeed speed;
    for (int i = 0; i <= kSamples; ++i) {
        const double clock = fraction(i) * trajectory.clockEnd();
        const auto at = trajectory.pathParameter({clock, limits.velocity, 0.0});
        speed.velocity = std::max(speed.velocity, at.velocity);
    }
    speed.acceleration = speed.velocity / limits.velocity * limits.acceleration;
    return speed;
}

/// What the axes may do along the path, as shares of what they can: at most 1.
void setShares(const RobotModel& model, const Trajectory& trajectory, const PathSpeed& speed,
               PlannedMotion& motion) {
    double velocity = 0.0;
    double acceleration = 0.0;
    auto before = trajectory.start();
    for (int i = 1; i <= kSamples; ++i) {
        const auto now = trajectory.positionAt(fraction(i));
        for (std::size_t axis = 0; axis < now.size(); ++axis) {
            const double slope = std::abs(now[axis] - before[axis]) * kSamples;
            const auto& limits = model.limits(axis);
            velocity = std::max(velocity, slope * speed.velocity / limits.velocity);
            acceleration = std::max(acceleration, slope * speed.acceleration / limits.acceleration);
        }
        before = now;
    }
    // Without any way there is no speed to limit.
    motion.velocity_share = velocity > 0.0 ? std::min(velocity, 1.0) : 1.0;
    motion.acceleration_share = acceleration > 0.0 ? std::min(acceleration, 1.0) : 1.0;
}

Result<void> checkElbow(const RobotModel& model, const Trajectory& trajectory) {
    const auto& kinematics = model.kinematics();
    const double turned =
        std::abs(std::remainder(kinematics.redundancyAngle(trajectory.end()) -
                                    kinematics.redundancyAngle(trajectory.start()),
                                2.0 * M_PI));
    if (turned <= kSameElbow) {
        return {};
    }
    return fail(Errc::not_supported,
                fmt::format("the line ends in another configuration: the elbow {:.4f} rad from "
                            "where it begins, limit {} rad; the controller's own line keeps it",
                            turned, kSameElbow));
}

/// The tool frame when the flange is so far along its own straight line.
Pose toolOnFlangeLine(const Pose& from, const Pose& to, const Pose& flange_from_tool, double part) {
    const Pose flange{from.translation + part * (to.translation - from.translation),
                      geometry::slerp(from.rotation, to.rotation, part)};
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
    return fail(Errc::not_supported,
                fmt::format("the controller's line is one of the flange: the tool frame would be "
                            "{:.4f} m off its own, limit {} m; use the flange, or keep the "
                            "orientation",
                            worst, kStraight));
}

}  // namespace

Result<void> checkNoStartTime(const device::Arm& arm, const std::optional<double>& start_time) {
    if (!start_time) {
        return {};
    }
    return fail(Errc::not_supported,
                arm.info().name +
                    ": StartTime: its controller plans the motion and begins at once; a move over "
                    "its position stream can wait");
}

Result<PlannedMotion> plannedMotion(const RobotModel& model, const Trajectory& trajectory,
                                    PathDeviationMeter::Path path) {
    PlannedMotion motion;
    motion.target_joints = toArray(trajectory.end());
    const auto speed = pathSpeed(trajectory);
    if (path == PathDeviationMeter::Path::joint_line) {
        setShares(model, trajectory, speed, motion);
        return motion;
    }
    if (auto same = checkElbow(model, trajectory); !same) {
        return fail(std::move(same.error()));
    }
    if (auto same = checkSameLine(model, trajectory); !same) {
        return fail(std::move(same.error()));
    }
    motion.path = PlannedMotion::Path::line;
    motion.target_flange = geometry::toFrame(model.kinematics().forward(trajectory.end()));
    if (trajectory.length() < kShortLine) {
        setShares(model, trajectory, speed, motion);
        return motion;
    }
    motion.line_velocity = speed.velocity * trajectory.length();
    motion.line_acceleration = speed.acceleration * trajectory.length();
    return motion;
}

}  // namespace metier::robot_skills
