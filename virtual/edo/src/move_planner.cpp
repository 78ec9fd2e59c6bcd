#include "move_planner.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "codes.hpp"
#include "metier/motion/rotation.hpp"

namespace metier::virtual_edo {
namespace {

// Targets so far outside the stroke are taken as its end [deg], [mm].
constexpr double kClamp = 0.2;
// Joint positions along a line or arc are computed this close together [m], [rad].
constexpr double kStep = 0.0005;
constexpr double kAngleStep = 0.005;
// A move that an axis would slow down more than this is refused, as near a singularity.
constexpr double kSlowest = 0.02;
// The longest way that a linear jog looks ahead [m].
constexpr double kJogReach = 1.0;
// Smallest value of a jog that counts, and margin at the end of a stroke [deg], [mm].
constexpr double kLeastJog = 0.01;
constexpr double kJogMargin = 0.1;
constexpr double kGripperJogMargin = 0.2;
constexpr double kJogOverride = 0.5;

motion::Pose interpolate(const motion::Pose& from, const motion::Pose& to, double share) {
    return {.translation = from.translation + share * (to.translation - from.translation),
            .rotation = motion::slerp(from.rotation, to.rotation, share)};
}

}  // namespace

struct MovePlanner::ToolPath {
    double length = 0.0;                     // [m]
    double angle = 0.0;                      // [rad]
    std::function<motion::Pose(double)> at;  // flange, from 0 to 1
};

MovePlanner::MovePlanner(const motion::RobotModel& model)
    : model_(model), limits_(limitsOf(model)) {}

void MovePlanner::setReference(const Movement& movement) {
    base_from_frame_ = toPose(movement.frame);
    flange_from_tool_ = toPose(movement.tool);
}

motion::Pose MovePlanner::baseFromFlange(const AxisValues& position) const {
    return model_.kinematics().forward(armRadians(position));
}

CartesianPose MovePlanner::cartesian(const AxisValues& position) const {
    return toCartesian(base_from_frame_.inverse() * baseFromFlange(position) * flange_from_tool_);
}

motion::Pose MovePlanner::flangeGoal(const CartesianPose& target) const {
    return base_from_frame_ * toPose(target) * flange_from_tool_.inverse();
}

Result<AxisValues> MovePlanner::inverse(const AxisValues& near,
                                        const motion::Pose& base_from_flange) const {
    METIER_ASSIGN(auto solution,
                  model_.kinematics().inverse(
                      base_from_flange,
                      {.reference = armRadians(near), .bounds = {}, .redundancy_angle = {}}));
    AxisValues values = near;
    setArm(values, solution);
    return values;
}

Result<AxisValues> MovePlanner::jointTarget(const AxisValues& start, std::size_t axes,
                                            const Point& point) const {
    AxisValues target = start;
    for (std::size_t axis = 0; axis < std::min(axes, point.joints.size()); ++axis) {
        if (!inMask(point.joints_mask, axis)) {
            continue;
        }
        const auto& limit = limits_[axis];
        target[axis] = std::clamp(point.joints[axis], limit.lower, limit.upper);
        if (std::abs(target[axis] - point.joints[axis]) >= kClamp) {
            return fail(Errc::out_of_range,
                        fmt::format("axis {}: {} is outside the stroke {} to {}", axis + 1,
                                    point.joints[axis], limit.lower, limit.upper));
        }
    }
    return target;
}

Result<AxisValues> MovePlanner::moveTarget(const AxisValues& start, std::size_t axes,
                                           const Point& point) const {
    if (point.data_type == point_type::kJoint) {
        return jointTarget(start, axes, point);
    }
    auto target = inverse(start, flangeGoal(point.pose));
    if (!target || point.data_type == point_type::kCartesian) {
        return target;
    }
    // Extended: the axes beyond the arm's come from the joints.
    Point auxiliary = point;
    auxiliary.joints_mask &= ~maskOf(kArmAxes);
    return jointTarget(*target, axes, auxiliary);
}

Result<Segment> MovePlanner::planMove(const AxisValues& start, std::size_t axes,
                                      const Movement& movement) {
    setReference(movement);
    if (movement.override_percent > 0) {
        override_ = std::min(movement.override_percent / 100.0, 1.0);
    }
    METIER_ASSIGN(const auto target, moveTarget(start, axes, movement.target));
    if (movement.type == move_type::kJoint) {
        return planJoints(start, target);
    }
    if (movement.type == move_type::kLinear) {
        return planLine(start, target, baseFromFlange(target));
    }
    const auto via = moveTarget(start, axes, movement.via);
    return via ? planArc(start, *via, target) : fail(via.error());
}

Result<Segment> MovePlanner::planJoints(const AxisValues& start, const AxisValues& target) const {
    std::vector<AxisValues> path{start, target};
    auto profile = profileFor(path, 0.0, 0.0);
    return Segment(std::move(path), profile);
}

virtual_controller::Trapezoid MovePlanner::profileFor(const std::vector<AxisValues>& path,
                                                      double length, double angle) const {
    const auto& tool = model_.cartesianLimits();
    // Lets a motion without a way take a cycle.
    double velocity = 1.0 / kCycleSeconds;
    double acceleration = 4.0 / (kCycleSeconds * kCycleSeconds);
    const auto limit = [&](double way, double most_velocity, double most_acceleration) {
        if (way > 0.0) {
            velocity = std::min(velocity, most_velocity / way);
            acceleration = std::min(acceleration, most_acceleration / way);
        }
    };
    const auto steps = static_cast<double>(path.size() - 1);
    for (std::size_t axis = 0; axis < kMostAxes; ++axis) {
        double largest = 0.0;
        for (std::size_t i = 1; i < path.size(); ++i) {
            largest = std::max(largest, std::abs(path[i][axis] - path[i - 1][axis]) * steps);
        }
        limit(largest, limits_[axis].velocity, limits_[axis].acceleration);
    }
    limit(length, tool.velocity, tool.acceleration);
    limit(angle, tool.angular_velocity, tool.angular_acceleration);
    return {1.0, velocity * override_, acceleration * override_};
}

Result<Segment> MovePlanner::follow(const AxisValues& start, const AxisValues& target,
                                    const ToolPath& way) const {
    const auto steps = static_cast<std::size_t>(
        std::ceil(std::max({way.length / kStep, way.angle / kAngleStep, 1.0})));
    std::vector<AxisValues> path{start};
    for (std::size_t i = 1; i <= steps; ++i) {
        const double share = static_cast<double>(i) / static_cast<double>(steps);
        const auto solution =
            model_.kinematics().solutionNear(way.at(share), armRadians(path.back()), 0.0);
        if (solution.empty() || !model_.kinematics().withinLimits(solution)) {
            return fail(Errc::unreachable, "the way leaves the reach or the strokes");
        }
        path.push_back(start);
        setArm(path.back(), solution);
        path.back()[kGripper] = start[kGripper] + share * (target[kGripper] - start[kGripper]);
    }
    const auto profile = profileFor(path, way.length, way.angle);
    const auto& tool = model_.cartesianLimits();
    const double wanted =
        override_ * std::min(way.length > 0 ? tool.velocity / way.length : 1e9,
                             way.angle > 0 ? tool.angular_velocity / way.angle : 1e9);
    const double cruise =
        (profile.at(profile.duration() / 2 + 1e-4) - profile.at(profile.duration() / 2 - 1e-4)) /
        2e-4;
    if (wanted < 1e8 && cruise < kSlowest * wanted) {
        return fail(Errc::unreachable, "the way passes a singularity");
    }
    return Segment(std::move(path), profile);
}

Result<Segment> MovePlanner::planLine(const AxisValues& start, const AxisValues& target,
                                      const motion::Pose& goal) const {
    // The tool frame moves on the line, not the flange.
    const auto from = baseFromFlange(start) * flange_from_tool_;
    const auto to = goal * flange_from_tool_;
    const auto tool_from_flange = flange_from_tool_.inverse();
    return follow(
        start, target,
        {.length = motion::distanceBetween(from, to),
         .angle = motion::rotationAngleBetween(from.rotation, to.rotation),
         .at = [=](double share) { return interpolate(from, to, share) * tool_from_flange; }});
}

Result<Segment> MovePlanner::planArc(const AxisValues& start, const AxisValues& via,
                                     const AxisValues& target) const {
    const auto from = baseFromFlange(start) * flange_from_tool_;
    const auto to = baseFromFlange(target) * flange_from_tool_;
    const auto through = (baseFromFlange(via) * flange_from_tool_).translation;
    const Eigen::Vector3d a = through - from.translation;
    const Eigen::Vector3d b = to.translation - from.translation;
    const Eigen::Vector3d normal = a.cross(b);
    if (normal.norm() < 1e-9) {
        return fail(Errc::invalid_argument, "the three points of the arc are on a line");
    }
    const Eigen::Vector3d centre =
        from.translation +
        (a.squaredNorm() * b - b.squaredNorm() * a).cross(normal) / (2.0 * normal.squaredNorm());
    const Eigen::Vector3d arm = from.translation - centre;
    const Eigen::Vector3d axis = normal.normalized();
    const Eigen::Vector3d last = to.translation - centre;
    double turn = std::atan2(axis.dot(arm.cross(last)), arm.dot(last));
    turn += turn <= 0.0 ? 2.0 * std::numbers::pi : 0.0;
    const auto tool_from_flange = flange_from_tool_.inverse();
    return follow(start, target,
                  {.length = arm.norm() * turn,
                   .angle = motion::rotationAngleBetween(from.rotation, to.rotation),
                   .at = [=](double share) {
                       auto pose = interpolate(from, to, share);
                       pose.translation = centre + Eigen::AngleAxisd(share * turn, axis) * arm;
                       return pose * tool_from_flange;
                   }});
}

Result<Segment> MovePlanner::planJog(const AxisValues& start, std::size_t axes,
                                     const Movement& movement) {
    setReference(movement);
    if (movement.type == move_type::kLinear && movement.target.data_type != point_type::kJoint) {
        return planLinearJog(start, movement.target.pose);
    }
    if (movement.type != move_type::kJoint || movement.target.data_type != point_type::kJoint) {
        return fail(Errc::invalid_argument, "the kind of point does not fit the jog");
    }
    return planJoints(start, jogTarget(start, axes, movement.target));
}

AxisValues MovePlanner::jogTarget(const AxisValues& start, std::size_t axes, const Point& point) {
    AxisValues target = start;
    double least = 1.0;
    for (std::size_t axis = 0; axis < std::min(axes, point.joints.size()); ++axis) {
        const double value = point.joints[axis];
        if (!inMask(point.joints_mask, axis) || std::abs(value) <= kLeastJog) {
            continue;
        }
        const double margin = axis == kGripper ? kGripperJogMargin : kJogMargin;
        least = std::min(least, std::abs(value));
        target[axis] = value < 0 ? limits_[axis].lower + margin : limits_[axis].upper - margin;
    }
    override_ = std::max(least * kJogOverride, 0.01);
    return target;
}

Result<Segment> MovePlanner::planLinearJog(const AxisValues& start,
                                           const CartesianPose& direction) {
    const Eigen::Vector3d along(direction.x, direction.y, direction.z);
    const Eigen::Vector3d turn(direction.a, direction.e, direction.r);
    const double size = std::hypot(along.norm(), turn.norm());
    if (size <= kLeastJog) {
        return fail(Errc::invalid_argument, "the jog has no direction");
    }
    override_ = std::clamp(size, 0.02, 1.0) * kJogOverride;
    const auto from = baseFromFlange(start) * flange_from_tool_;
    // Searches the farthest point that the arm can reach, from far to near.
    for (double reach = kJogReach; reach > kStep; reach *= 0.7) {
        motion::Pose to = from;
        to.translation += along / size * reach;
        to.rotation = motion::fromRotationVector(turn / size * reach) * from.rotation;
        auto segment = planLine(start, start, to * flange_from_tool_.inverse());
        if (segment) {
            return segment;
        }
    }
    return fail(Errc::unreachable, "the jog leads out of the reach");
}

}  // namespace metier::virtual_edo
