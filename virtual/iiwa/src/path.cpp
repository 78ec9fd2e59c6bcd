#include "path.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "metier/motion/rotation.hpp"

namespace metier::virtual_iiwa {

namespace {

using motion::JointVector;
using motion::Pose;
using motion::ScalarLimits;

// A model's limits are those to plan with; the drives give more.
constexpr double kAccelerationReserve = 2.0;
constexpr double kJerkReserve = 10.0;
// A motion shorter than this is none [rad], [m].
constexpr double kNoWay = 1e-9;
// A Cartesian path is looked at in so many places before it starts.
constexpr int kSamples = 200;
// An axis does not turn further between two of them [rad].
constexpr double kLargestStep = 0.3;
// The cabinet's own limit of the jerk along a line [m/s3].
constexpr double kPathJerk = 100.0;

class JointPath final : public Path {
public:
    JointPath(const JointVector& start, const JointVector& target)
        : start_(start), target_(target) {}

    std::optional<JointVector> at(double parameter, const JointVector&) const override {
        JointVector position = start_;
        for (std::size_t axis = 0; axis < position.size(); ++axis) {
            position[axis] += parameter * (target_[axis] - start_[axis]);
        }
        return parameter >= 1.0 ? target_ : position;
    }

private:
    JointVector start_;
    JointVector target_;
};

/// base_from_tool by the parameter.
using PoseFunction = std::function<Pose(double)>;

class PosePath final : public Path {
public:
    PosePath(const MovingFrame& frame, const JointVector& start, PoseFunction pose)
        : frame_(frame),
          redundancy_angle_(frame.model->kinematics().redundancyAngle(start)),
          pose_(std::move(pose)) {}

    std::optional<JointVector> at(double parameter, const JointVector& near) const override {
        const auto& kinematics = frame_.model->kinematics();
        const auto found = kinematics.solutionNear(
            pose_(parameter) * frame_.flange_from_tool.inverse(), near, redundancy_angle_);
        if (found.empty() || !kinematics.withinLimits(found) ||
            motion::maxDifference(found, near) > kLargestStep) {
            return std::nullopt;
        }
        return found;
    }

private:
    MovingFrame frame_;
    double redundancy_angle_;
    PoseFunction pose_;
};

void atMost(double& limit, double bound) {
    limit = std::min(limit, bound);
}

/// Slows down so that no axis gets faster than it may, from places a step of the parameter apart.
void slowDownFor(ScalarLimits& limits, const ScalarLimits& axis, double slope, double bend) {
    if (slope > kNoWay) {
        atMost(limits.velocity, axis.velocity / slope);
        atMost(limits.acceleration, 0.5 * axis.acceleration / slope);
    }
    if (bend > kNoWay) {
        atMost(limits.velocity, std::sqrt(0.5 * axis.acceleration / bend));
    }
}

/// Walks along the path once: the arm gets everywhere, and no axis is too fast.
Planned inspected(std::unique_ptr<Path> path, const motion::RobotModel& model,
                  const JointVector& start, const MotionLimits& limits) {
    constexpr double step = 1.0 / kSamples;
    std::array<JointVector, 3> last{start, start, start};
    for (int sample = 0; sample <= kSamples; ++sample) {
        const auto found = path->at(sample * step, last[0]);
        if (!found) {
            return fail(Errc::unreachable, fmt::format("the arm cannot get to {:.0f} % of the path",
                                                       100.0 * sample * step));
        }
        last = {*found, last[0], last[1]};
        for (std::size_t axis = 0; sample > 0 && axis < start.size(); ++axis) {
            const double slope = (last[0][axis] - last[1][axis]) / step;
            const double before = (last[1][axis] - last[2][axis]) / step;
            const double bend = sample > 1 ? (slope - before) / step : 0.0;
            slowDownFor(path->limits, axisLimits(model, axis, limits), std::abs(slope),
                        std::abs(bend));
        }
    }
    return path;
}

Result<void> check(const MotionLimits& limits) {
    if (limits.joint_velocity > 0.0 && limits.joint_acceleration > 0.0 && limits.joint_jerk > 0.0) {
        return {};
    }
    return fail(Errc::invalid_argument, "a share of 0 of an axis limit moves nothing");
}

Result<void> check(const Pose& target) {
    if (target.translation.allFinite() && target.rotation.coeffs().allFinite()) {
        return {};
    }
    return fail(Errc::invalid_argument, "the target is not finite");
}

}  // namespace

ScalarLimits axisLimits(const motion::RobotModel& model, std::size_t axis,
                        const MotionLimits& limits) {
    const auto& most = model.limits(axis);
    return {limits.joint_velocity * most.velocity,
            limits.joint_acceleration * kAccelerationReserve * most.acceleration,
            limits.joint_jerk * kJerkReserve * most.jerk};
}

Planned planPtp(const motion::RobotModel& model, const JointVector& start,
                const JointVector& target, const MotionLimits& limits) {
    METIER_TRY(check(limits));
    if (!model.kinematics().withinLimits(target)) {
        return fail(Errc::out_of_range, "the target is outside of the joint limits");
    }
    auto path = std::make_unique<JointPath>(start, target);
    path->limits = {1e3, 1e6, 1e9};
    for (std::size_t axis = 0; axis < start.size(); ++axis) {
        const double way = std::abs(target[axis] - start[axis]);
        if (way > kNoWay) {
            const auto most = axisLimits(model, axis, limits);
            atMost(path->limits.velocity, most.velocity / way);
            atMost(path->limits.acceleration, most.acceleration / way);
            atMost(path->limits.jerk, most.jerk / way);
        }
    }
    return path;
}

Planned planPtp(const MovingFrame& frame, const JointVector& start, const Pose& base_from_tool,
                const MotionLimits& limits) {
    METIER_TRY(check(base_from_tool));
    const auto target = frame.model->kinematics().inverse(
        base_from_tool * frame.flange_from_tool.inverse(), {start, {}, {}});
    return target ? planPtp(*frame.model, start, *target, limits) : fail(target.error());
}

Planned planLinear(const MovingFrame& frame, const JointVector& start, const Pose& base_from_tool,
                   const MotionLimits& limits) {
    METIER_TRY(check(base_from_tool));
    METIER_TRY(check(limits));
    const Pose from = frame.model->kinematics().forward(start) * frame.flange_from_tool;
    const double length = std::max(motion::distanceBetween(from, base_from_tool), kNoWay);
    const double angle =
        std::max(motion::rotationAngleBetween(from.rotation, base_from_tool.rotation), kNoWay);
    const auto& turning = frame.model->cartesianLimits();
    const ScalarLimits path_limits{
        std::min(limits.velocity / length, turning.angular_velocity / angle),
        std::min(limits.acceleration / length, turning.angular_acceleration / angle),
        std::min(kPathJerk / length, turning.angular_jerk / angle)};
    const auto pose = [from, to = base_from_tool](double parameter) {
        return Pose{from.translation + parameter * (to.translation - from.translation),
                    motion::slerp(from.rotation, to.rotation, parameter)};
    };
    auto path = std::make_unique<PosePath>(frame, start, pose);
    path->limits = path_limits;
    return inspected(std::move(path), *frame.model, start, limits);
}

Planned planCircle(const MovingFrame& frame, const JointVector& start, const CirclePoints& points,
                   const MotionLimits& limits) {
    METIER_TRY(check(limits));
    const Pose from = frame.model->kinematics().forward(start) * frame.flange_from_tool;
    const Eigen::Vector3d to_auxiliary = points.auxiliary - from.translation;
    const Eigen::Vector3d to_end = points.end - from.translation;
    const Eigen::Vector3d normal = to_auxiliary.cross(to_end);
    if (!(normal.norm() > 1e-6 * to_auxiliary.norm() * to_end.norm())) {
        return fail(Errc::invalid_argument, "three points on a line make no circle");
    }
    const Eigen::Vector3d to_centre = (to_auxiliary.squaredNorm() * to_end.cross(normal) +
                                       to_end.squaredNorm() * normal.cross(to_auxiliary)) /
                                      (2.0 * normal.squaredNorm());
    const Eigen::Vector3d axis = normal.normalized();
    const Eigen::Vector3d end_spoke = to_end - to_centre;
    double angle = std::atan2(axis.dot(-to_centre.cross(end_spoke)), -to_centre.dot(end_spoke));
    angle += angle <= 0.0 ? 2.0 * std::numbers::pi : 0.0;
    const double length = angle * to_centre.norm();
    const ScalarLimits path_limits{limits.velocity / length, limits.acceleration / length,
                                   kPathJerk / length};
    const auto pose = [from, to_centre, axis, angle](double parameter) {
        const Eigen::Vector3d spoke = Eigen::AngleAxisd(parameter * angle, axis) * -to_centre;
        return Pose{from.translation + to_centre + spoke, from.rotation};
    };
    auto path = std::make_unique<PosePath>(frame, start, pose);
    path->limits = path_limits;
    return inspected(std::move(path), *frame.model, start, limits);
}

}  // namespace metier::virtual_iiwa
