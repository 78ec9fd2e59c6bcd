#include "moves/stop_time.hpp"

#include <algorithm>
#include <cmath>

#include "metier/motion/motion_run.hpp"

namespace metier::robot_skills {

using motion::MotionRun;
using motion::RobotModel;
using motion::Seconds;
using motion::Trajectory;

namespace {

constexpr double kMostAcceleration = 1.2;  // share of the robot's own
constexpr double kMostJerk = 2.0;          // as a Halt may use
constexpr int kBeginnings = 25;            // number of begins of the brake, over the motion
constexpr int kSteps = 20;                 // number of steps of one brake
constexpr double kLonger = 1.15;
constexpr double kShortest = 1e-3;       // [s]
constexpr double kLongestBraking = 4.0;  // [s]

/// Whether all axes can follow from one set-point to the next.
bool canFollow(const RobotModel& model, const motion::SetPoint& from, const motion::SetPoint& to,
               double step) {
    for (std::size_t axis = 0; axis < to.position.size(); ++axis) {
        const auto& limits = model.limits(axis);
        const double jerk = (to.acceleration[axis] - from.acceleration[axis]) / step;
        if (std::abs(to.acceleration[axis]) > kMostAcceleration * limits.acceleration ||
            std::abs(jerk) > kMostJerk * limits.jerk) {
            return false;
        }
    }
    return true;
}

bool canStop(const Trajectory& trajectory, const RobotModel& model, double begin, double length) {
    MotionRun execution(trajectory);
    auto before = execution.next(Seconds(begin));
    execution.stopIn(Seconds(length));
    const double step = length / kSteps;
    for (int i = 0; i < kSteps && !execution.atRest(); ++i) {
        const auto now = execution.next(Seconds(step));
        if (!canFollow(model, before, now, step)) {
            return false;
        }
        before = now;
    }
    return true;
}

bool canAlwaysStop(const Trajectory& trajectory, const RobotModel& model, double length) {
    for (int i = 1; i < kBeginnings; ++i) {
        const double begin = trajectory.duration().count() * i / kBeginnings;
        if (!canStop(trajectory, model, begin, length)) {
            return false;
        }
    }
    return true;
}

}  // namespace

double stopTimeFor(const Trajectory& trajectory, const RobotModel& model,
                   const std::optional<double>& asked) {
    double length = asked.value_or(0.0);
    if (length <= 0.0) {
        return 0.0;
    }
    for (length = std::max(length, kShortest); length <= kLongestBraking; length *= kLonger) {
        if (canAlwaysStop(trajectory, model, length)) {
            return length;
        }
    }
    return 0.0;
}

}  // namespace metier::robot_skills
