#include "metier/robot_skills/move_planning.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <utility>

#include "conversions.hpp"
#include "metier/motion/frame.hpp"

namespace metier::robot_skills {

using motion::JointVector;
using motion::Planned;
using motion::RobotModel;
using motion::Trajectory;

namespace {

bool allZero(const std::vector<double>& values) {
    return std::all_of(values.begin(), values.end(), [](double v) { return v == 0.0; });
}

/// Per-axis maxima for the planner: empty for "not set", whatever its length.
JointVector axisMaxima(const std::vector<double>& values) {
    return allZero(values) ? JointVector() : JointVector::from(values).value_or(JointVector());
}

motion::CartesianVector cartesianMaxima(const std::vector<double>& values) {
    motion::CartesianVector maxima{};
    if (!allZero(values)) {
        std::copy_n(values.begin(), std::min(values.size(), maxima.size()), maxima.begin());
    }
    return maxima;
}

motion::AxisBounds axisBounds(const std::vector<skill::Range>& ranges) {
    const bool not_set = std::all_of(ranges.begin(), ranges.end(), [](const skill::Range& range) {
        return range == skill::Range{};
    });
    if (not_set) {
        return {};
    }
    motion::AxisBounds bounds{JointVector(ranges.size()), JointVector(ranges.size())};
    for (std::size_t axis = 0; axis < ranges.size(); ++axis) {
        bounds.lower[axis] = ranges[axis].low;
        bounds.upper[axis] = ranges[axis].high;
    }
    return bounds;
}

motion::TargetReference reference(const MoveParameters& parameters) {
    switch (static_cast<Relative>(parameters.relative)) {
        case Relative::absolute:
            return motion::TargetReference::base;
        case Relative::base:
            return motion::TargetReference::relative_base;
        case Relative::tool:
            return motion::TargetReference::relative_tool;
    }
    return motion::TargetReference::base;
}

JointVector jointTarget(const JointVector& start, const JointMoveParameters& parameters) {
    auto target = JointVector::from(parameters.target_joint_position).value_or(start);
    if (static_cast<Relative>(parameters.relative) == Relative::base) {
        target.view() += start.view();
    }
    return target;
}

/// \param maxima makes the planner's limits of the parameters' lists
template <typename Request, typename Maxima>
Request commonRequest(const JointVector& start, const MoveParameters& parameters, Maxima maxima) {
    Request request;
    request.start = start;
    request.tool_frame = parameters.tool_frame;
    request.max_velocity = maxima(parameters.max_velocity);
    request.max_acceleration = maxima(parameters.max_acceleration);
    request.speed_override = parameters.speed_override;
    request.redundancy_angle = parameters.redundancy_angle;
    return request;
}

motion::PtpRequest ptpRequest(const JointVector& start, const MoveParameters& parameters) {
    return commonRequest<motion::PtpRequest>(start, parameters, axisMaxima);
}

motion::LinRequest commonLinRequest(const JointVector& start, const MoveParameters& parameters) {
    return commonRequest<motion::LinRequest>(start, parameters, cartesianMaxima);
}

tl::unexpected<motion::Refusal> outOfRange(std::string text) {
    motion::Refusal refusal;
    refusal.error = {Errc::out_of_range, std::move(text)};
    return tl::unexpected(std::move(refusal));
}

/// The motion as long as it is asked to be.
Planned<Trajectory> lasting(Planned<Trajectory> plan, const MoveParameters& parameters) {
    constexpr double rounding = 1e-6;  // [s]
    if (!plan || !parameters.duration) {
        return plan;
    }
    const double shortest = plan->duration().count();
    if (*parameters.duration < shortest - rounding) {
        return outOfRange(fmt::format("Duration {} s is shorter than possible: {:.4f} s",
                                      *parameters.duration, shortest));
    }
    return plan->stretchedTo(motion::Seconds(*parameters.duration));
}

/// One value per pose, or none at all.
motion::Planned<void> checkCount(std::string_view name, std::size_t count, std::size_t poses) {
    if (count == 0 || count == poses) {
        return {};
    }
    return outOfRange(fmt::format("{}: {} values for {} poses", name, count, poses));
}

}  // namespace

motion::LinRequest linRequest(const JointVector& start, const CartesianMoveParameters& parameters) {
    auto request = commonLinRequest(start, parameters);
    request.target = motion::toPose(parameters.target_position);
    request.reference = reference(parameters);
    request.axis_bounds = axisBounds(parameters.axis_bounds);
    return request;
}

Planned<Trajectory> planCartesianPtp(const RobotModel& model, const JointVector& start,
                                     const CartesianMoveParameters& parameters) {
    auto request = ptpRequest(start, parameters);
    request.target = motion::toPose(parameters.target_position);
    request.reference = reference(parameters);
    request.axis_bounds = axisBounds(parameters.axis_bounds);
    if (parameters.next_position) {
        request.next_line = motion::toPose(*parameters.next_position);
    }
    return lasting(motion::Planner(model).ptp(request), parameters);
}

Planned<Trajectory> planCartesianLinear(const RobotModel& model, const JointVector& start,
                                        const CartesianMoveParameters& parameters) {
    return lasting(motion::Planner(model).lin(linRequest(start, parameters)), parameters);
}

Planned<Trajectory> planCartesianPath(const RobotModel& model, const JointVector& start,
                                      const PathMoveParameters& parameters) {
    const auto& poses = parameters.poses;
    const auto& radii = parameters.blend_radii;
    const auto& speeds = parameters.speeds;
    METIER_TRY(checkCount("BlendRadii", radii.size(), poses.size()));
    METIER_TRY(checkCount("Speeds", speeds.size(), poses.size()));
    motion::PathRequest request{commonLinRequest(start, parameters), {}};
    request.lin.reference = reference(parameters);
    for (std::size_t i = 0; i < poses.size(); ++i) {
        request.waypoints.push_back({.target = motion::toPose(poses[i]),
                                     .blend_radius = radii.empty() ? 0.0 : radii[i],
                                     .max_velocity = speeds.empty() ? 0.0 : speeds[i]});
    }
    return lasting(motion::Planner(model).path(request), parameters);
}

Planned<Trajectory> planJointPtp(const RobotModel& model, const JointVector& start,
                                 const JointMoveParameters& parameters) {
    auto request = ptpRequest(start, parameters);
    request.target = jointTarget(start, parameters);
    return lasting(motion::Planner(model).ptp(request), parameters);
}

Planned<Trajectory> planJointLinear(const RobotModel& model, const JointVector& start,
                                    const JointMoveParameters& parameters) {
    return lasting(motion::Planner(model).jointLinear(
                       {commonLinRequest(start, parameters), jointTarget(start, parameters)}),
                   parameters);
}

}  // namespace metier::robot_skills
