#include "metier/motion/planner.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "line_tracker.hpp"
#include "metier/base/numbers.hpp"
#include "path_layout.hpp"
#include "plan.hpp"
#include "request_check.hpp"
#include "self_collision.hpp"
#include "singularity.hpp"
#include "tool_limits.hpp"

namespace metier::motion {

namespace {

double perAxis(const JointVector& values, std::size_t axis) {
    return values.empty() ? 0.0 : values[axis];
}

ScalarLimits limitsOfJointLine(const RobotModel& model, const PtpRequest& request,
                               const JointVector& delta) {
    ScalarLimits limits{kInfinity, kInfinity, kInfinity};
    for (std::size_t i = 0; i < delta.size(); ++i) {
        const double distance = std::abs(delta[i]);
        if (distance == 0) {
            continue;
        }
        const JointLimits& own = model.limits(i);
        const double velocity =
            capped(perAxis(request.max_velocity, i), own.velocity) * request.speed_override;
        const double acceleration = capped(perAxis(request.max_acceleration, i), own.acceleration);
        limits.velocity = std::min(limits.velocity, velocity / distance);
        limits.acceleration = std::min(limits.acceleration, acceleration / distance);
        limits.jerk = std::min(limits.jerk, own.jerk / distance);
    }
    return limits;
}

Trajectory makeTrajectory(const RobotModel& model, std::variant<JointLine, JointPath> path,
                          SpeedPlan speed, const Pose& flange_from_tool) {
    auto braking =
        std::visit([&](const auto& of) { return LimitsAlong::ofRobot(model, of); }, path);
    return Trajectory(std::make_shared<const Trajectory::Plan>(
        Trajectory::Plan{model.kinematics(), std::move(path), std::move(speed), flange_from_tool,
                         std::move(braking)}));
}

/// A motion that is over as soon as it starts.
Trajectory standStill(const RobotModel& model, const JointVector& q, const Pose& flange_from_tool) {
    return makeTrajectory(model, JointLine{q, JointVector(q.size())},
                          evenSpeed({kInfinity, kInfinity, kInfinity}), flange_from_tool);
}

Trajectory planJointLine(const RobotModel& model, const PtpRequest& request,
                         const JointVector& target, const Pose& flange_from_tool) {
    JointVector delta = target;
    delta.view() -= request.start.view();
    const ScalarLimits limits = limitsOfJointLine(model, request, delta);
    if (limits.velocity == kInfinity) {
        return standStill(model, request.start, flange_from_tool);
    }
    return makeTrajectory(model, JointLine{request.start, delta}, evenSpeed(limits),
                          flange_from_tool);
}

/// Refuses a motion in which two links would touch, nearer than they are at its start.
Planned<Trajectory> withoutCollision(const RobotModel& model, Trajectory trajectory) {
    constexpr double step = 0.03;       // step of the axis that moves most [rad]
    constexpr double worsening = 1e-3;  // [m]
    const SelfCollision collision(model);
    const auto at_start = collision.nearest(trajectory.start());
    if (!at_start) {
        return trajectory;
    }
    const double allowed = std::min(0.0, at_start->distance - worsening);
    const double moved = maxDifference(trajectory.start(), trajectory.end());
    const auto count =
        static_cast<int>(std::clamp(2 * moved / step + trajectory.length() / 0.01, 8.0, 1000.0));
    for (int i = 1; i <= count; ++i) {
        const double fraction = static_cast<double>(i) / count;
        const auto nearest = collision.nearest(trajectory.positionAt(fraction));
        if (nearest->distance < allowed) {
            Refusal refusal = refuse(
                RefusalReason::collision, Errc::out_of_range,
                fmt::format("{} and {} would touch: {:.4f} m apart, limit {:.4f} m, at {:.1f} % of "
                            "the path",
                            collision.linkName(nearest->first), collision.linkName(nearest->second),
                            nearest->distance, allowed, 100 * fraction));
            refusal.fraction = fraction;
            return tl::unexpected(refusal);
        }
    }
    return trajectory;
}

/// Follows a path, unless it is singular.
Planned<TrackedPath> track(const TrackRequest& request, const PlannerOptions& options) {
    METIER_ASSIGN(auto path, trackLine(request));
    METIER_TRY(refuseSingular(*request.model, path, options));
    auto bounds = axisBounds(*request.model, path);
    return TrackedPath{std::move(path), std::move(bounds)};
}

/// \param limits of the tool frame from that knot to the next one
Trajectory quickestAlong(
    const RobotModel& model, TrackedPath path, const Pose& flange_from_tool,
    const std::function<ToolLimits(const TrackedPath&, std::size_t knot)>& limits) {
    const Kinematics& kinematics = model.kinematics();
    ExactPath exact;
    exact.position = [&](double s) { return path.joints.at(s, kinematics).q; };
    exact.tool.applies = [&](std::size_t knot) { return path.joints.leavesToolPath(knot); };
    exact.tool.factor = [&](std::size_t knot, const JointSteps& steps) {
        std::array<Pose, 3> poses;
        std::transform(
            steps.positions.begin(), steps.positions.end(), poses.begin(),
            [&](const JointVector& q) { return kinematics.forward(q) * flange_from_tool; });
        return toolExcess(poses, steps.step, limits(path, knot));
    };
    SpeedPlan speed = planSpeed(path.joints.places(), path.bounds, exact);
    return makeTrajectory(model, std::move(path.joints), std::move(speed), flange_from_tool);
}

Planned<ToolFrame> toolOf(const RobotModel& model, std::string_view name) {
    return model.tool(name).map_error([](const Error& error) {
        return refuse(RefusalReason::invalid_request, error.code, error.message);
    });
}

Refusal targetRefusal(const Error& error) {
    Refusal refusal = refuse(error.code == Errc::unreachable ? RefusalReason::unreachable
                                                             : RefusalReason::invalid_request,
                             error.code, "target: " + error.message);
    refusal.fraction = 1;
    return refusal;
}

/// \return the request without its path, which goes from `lin.start`
TrackRequest trackRequest(const RobotModel& model, const LinRequest& lin, const ToolFrame& tool) {
    TrackRequest request;
    request.model = &model;
    request.start = lin.start;
    request.bounds = lin.axis_bounds;
    request.end_arm_angle = lin.redundancy_angle;
    request.path.tool_from_flange = tool.flange_from_tool.inverse();
    return request;
}

/// The request of a line.
Planned<TrackRequest> trackRequestOf(const RobotModel& model, const LinRequest& request) {
    METIER_TRY(checkLin(model, request));
    METIER_ASSIGN(const auto tool, toolOf(model, request.tool_frame));
    const Pose start = model.kinematics().forward(request.start) * tool.flange_from_tool;
    TrackRequest wanted = trackRequest(model, request, tool);
    wanted.path.tool = ToolPath(start, absoluteTarget(start, request.target, request.reference));
    return wanted;
}

StoppingEstimate longestStop(const Trajectory& trajectory) {
    constexpr int kPlaces = 200;
    StoppingEstimate longest;
    MotionRun execution(trajectory);
    for (int i = 0; i < kPlaces; ++i) {
        execution.next(trajectory.duration() / kPlaces);
        const auto way = execution.stoppingEstimate();
        longest.time = std::max(longest.time, way.time);
        longest.distance = std::max(longest.distance, way.distance);
    }
    return longest;
}

}  // namespace

std::string_view toString(RefusalReason reason) noexcept {
    switch (reason) {
        case RefusalReason::invalid_request:
            return "invalid_request";
        case RefusalReason::unreachable:
            return "unreachable";
        case RefusalReason::joint_limit:
            return "joint_limit";
        case RefusalReason::configuration_change:
            return "configuration_change";
        case RefusalReason::singularity:
            return "singularity";
        case RefusalReason::collision:
            return "collision";
    }
    return "?";
}

Planned<Trajectory> Planner::ptp(const PtpRequest& request) const {
    const RobotModel& model = *model_;
    METIER_TRY(checkPtp(model, request));
    METIER_ASSIGN(const auto tool, toolOf(model, request.tool_frame));
    if (const auto* joints = std::get_if<JointVector>(&request.target)) {
        METIER_TRY(checkPosition(model, *joints, "target", 1e-9));
        return withoutCollision(model,
                                planJointLine(model, request, *joints, tool.flange_from_tool));
    }
    const Pose& pose = std::get<Pose>(request.target);
    METIER_TRY(checkPose(pose));
    const Pose start = model.kinematics().forward(request.start) * tool.flange_from_tool;
    const Pose flange =
        absoluteTarget(start, pose, request.reference) * tool.flange_from_tool.inverse();
    const auto target = model.kinematics().inverse(
        flange, {request.start, request.axis_bounds, request.redundancy_angle});
    if (!target) {
        return tl::unexpected(targetRefusal(target.error()));
    }
    if (request.next_line) {
        METIER_TRY(checkPose(*request.next_line));
        std::vector<JointVector> targets{*target};  // as without a next line, if that is possible
        const auto others = model.kinematics().inverseAll(
            flange, {request.start, request.axis_bounds, request.redundancy_angle});
        targets.insert(targets.end(), others.begin(), others.end());
        return ptpBeforeLine(request, targets, tool.flange_from_tool);
    }
    return withoutCollision(model, planJointLine(model, request, *target, tool.flange_from_tool));
}

Planned<Trajectory> Planner::ptpBeforeLine(const PtpRequest& request,
                                           const std::vector<JointVector>& targets,
                                           const Pose& flange_from_tool) const {
    constexpr std::size_t kMostTries = 16;
    const auto tries = std::min(targets.size(), kMostTries);
    LinRequest next;
    next.target = *request.next_line;
    next.tool_frame = request.tool_frame;
    std::optional<Refusal> nearest;
    for (std::size_t i = 0; i < tries; ++i) {
        next.start = targets[i];
        auto refused = refusalOf(next);
        if (!refused) {
            auto plan = withoutCollision(
                *model_, planJointLine(*model_, request, targets[i], flange_from_tool));
            if (plan) {
                return plan;
            }
            refused = plan.error();
        }
        nearest = nearest ? nearest : refused;
    }
    nearest->error.message = fmt::format(
        "the next line is possible from none of {} joint positions at the target; from the "
        "nearest: {}",
        tries, nearest->error.message);
    return tl::unexpected(std::move(*nearest));
}

/// Why a line cannot be planned; most of its cost is spared if the axes cannot follow it.
std::optional<Refusal> Planner::refusalOf(const LinRequest& request) const {
    const auto wanted = trackRequestOf(*model_, request);
    if (!wanted) {
        return wanted.error();
    }
    if (!wanted->path.tool.isPoint()) {
        if (const auto path = track(*wanted, options_); !path) {
            return path.error();
        }
    }
    const auto plan = lin(request);
    return plan ? std::nullopt : std::optional(plan.error());
}

Planned<Trajectory> Planner::lin(const LinRequest& request) const {
    METIER_ASSIGN(const auto tool, toolOf(*model_, request.tool_frame));
    METIER_ASSIGN(const auto wanted, trackRequestOf(*model_, request));
    if (wanted.path.tool.isPoint()) {
        return standStill(*model_, request.start, tool.flange_from_tool);
    }
    METIER_ASSIGN(auto path, track(wanted, options_));
    const ScalarLimits limits = limitsOfLine(*model_, request, wanted.path.tool);
    METIER_TRY(refuseCrawling(*model_, path, limits.velocity, options_));
    for (SpeedBounds& at : path.bounds) {
        at.add({1, 0, 0, limits.velocity, limits.acceleration, limits.jerk});
    }
    const ToolLimits of_tool = toolLimitsOf(*model_, request);
    return withoutCollision(
        *model_, quickestAlong(*model_, std::move(path), tool.flange_from_tool,
                               [&](const TrackedPath&, std::size_t) { return of_tool; }));
}

Planned<Trajectory> Planner::path(const PathRequest& request) const {
    METIER_TRY(checkPath(*model_, request));
    METIER_ASSIGN(const auto tool, toolOf(*model_, request.lin.tool_frame));
    TrackRequest wanted = trackRequest(*model_, request.lin, tool);
    METIER_TRY(layOut(*model_, request, tool.flange_from_tool, wanted.path.tool));
    if (wanted.path.tool.isPoint()) {
        return standStill(*model_, request.lin.start, tool.flange_from_tool);
    }
    auto path = track(wanted, options_);
    if (!path) {
        return tl::unexpected(onTheWay(path.error(), wanted.path.tool, request));
    }
    const double fastest = addToolBounds(*model_, request, path->joints, path->bounds);
    METIER_TRY(refuseCrawling(*model_, *path, fastest, options_));
    return withoutCollision(*model_, quickestAlong(*model_, std::move(*path), tool.flange_from_tool,
                                                   [&](const TrackedPath& of, std::size_t knot) {
                                                       return toolLimitsBetween(
                                                           of.bounds[knot], of.bounds[knot + 1],
                                                           model_->axisCount());
                                                   }));
}

Planned<Trajectory> Planner::jointLinear(const JointLinearRequest& request) const {
    METIER_TRY(checkPosition(*model_, request.target, "target", 1e-9));
    METIER_ASSIGN(const auto tool, toolOf(*model_, request.lin.tool_frame));
    LinRequest lin_request = request.lin;
    lin_request.target = model_->kinematics().forward(request.target) * tool.flange_from_tool;
    lin_request.reference = TargetReference::base;
    if (model_->kinematics().ikKind() == IkKind::arm_angle) {
        lin_request.redundancy_angle = model_->kinematics().redundancyAngle(request.target);
    }
    return lin(lin_request);
}

Feasibility assess(const Planned<Trajectory>& plan, std::size_t preview_points) {
    Feasibility result;
    if (!plan) {
        result.refusal = plan.error();
        return result;
    }
    result.duration = plan->duration();
    result.longest_stop = longestStop(*plan);
    for (std::size_t i = 0; i < preview_points; ++i) {
        const double share = static_cast<double>(i) /
                             static_cast<double>(std::max<std::size_t>(preview_points, 2) - 1);
        result.preview.push_back(plan->sample(share * plan->duration()).position);
    }
    return result;
}

}  // namespace metier::motion
