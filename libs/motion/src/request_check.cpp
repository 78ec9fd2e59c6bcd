#include "request_check.hpp"

#include <array>
#include <cmath>

namespace metier::motion {

Refusal refuse(RefusalReason reason, Errc code, std::string text, std::optional<std::size_t> axis) {
    return {reason, {code, std::move(text)}, 0, axis};
}

tl::unexpected<Refusal> invalid(std::string text, Errc code) {
    return tl::unexpected(refuse(RefusalReason::invalid_request, code, std::move(text)));
}

Checked checkPosition(const RobotModel& model, const JointVector& q, std::string_view what,
                      double tolerance) {
    if (q.size() != model.axisCount() || !q.allFinite()) {
        return invalid(fmt::format("{}: not {} finite joint values", what, model.axisCount()));
    }
    for (std::size_t i = 0; i < q.size(); ++i) {
        const JointLimits& limits = model.limits(i);
        if (q[i] >= limits.lower - tolerance && q[i] <= limits.upper + tolerance) {
            continue;
        }
        const bool over = q[i] > limits.upper;
        return tl::unexpected(
            refuse(RefusalReason::joint_limit, Errc::out_of_range,
                   fmt::format("{}: axis {}: {:.4f} rad {} limit {:.4f} rad", what, i + 1, q[i],
                               over ? "over" : "under", over ? limits.upper : limits.lower),
                   i));
    }
    return {};
}

Checked checkPose(const Pose& pose) {
    if (!pose.translation.allFinite() || !(std::abs(pose.rotation.norm() - 1.0) < 1e-6)) {
        return invalid("the target is not a finite position and a unit quaternion");
    }
    return {};
}

namespace {

/// The arm may stand this far beyond a limit and still start [rad].
constexpr double kStartTolerance = 1e-3;
template <typename Values>
Checked checkLimitValues(const Values& values, std::string_view what) {
    for (const double value : values) {
        if (!std::isfinite(value) || value < 0) {
            return invalid(fmt::format("{}: {} is not a finite number >= 0", what, value),
                           Errc::out_of_range);
        }
    }
    return {};
}

Checked checkOverride(double factor) {
    if (!(factor > 0 && factor <= 1)) {
        return invalid(fmt::format("speed override {} is not in (0, 1]", factor),
                       Errc::out_of_range);
    }
    return {};
}

Checked checkBounds(const RobotModel& model, const AxisBounds& bounds) {
    if (!bounds.isSet()) {
        return {};
    }
    if (bounds.lower.size() != model.axisCount() || bounds.upper.size() != model.axisCount() ||
        !bounds.lower.allFinite() || !bounds.upper.allFinite()) {
        return invalid(fmt::format("axis bounds are not {} finite ranges", model.axisCount()));
    }
    for (std::size_t i = 0; i < model.axisCount(); ++i) {
        if (bounds.lower[i] > bounds.upper[i]) {
            return invalid(fmt::format("axis bounds of axis {}: low {} rad over high {} rad", i + 1,
                                       bounds.lower[i], bounds.upper[i]),
                           Errc::out_of_range);
        }
    }
    return {};
}

/// The first failed one of some checks.
Checked all(std::initializer_list<Checked> checks) {
    for (const auto& check : checks) {
        if (!check) {
            return check;
        }
    }
    return {};
}

Checked checkArmAngle(const std::optional<double>& angle) {
    if (!std::isfinite(angle.value_or(0))) {
        return invalid(fmt::format("arm angle {} rad is not finite", *angle));
    }
    return {};
}

Checked checkAxisLimits(const RobotModel& model, const JointVector& values, std::string_view what) {
    if (!values.empty() && values.size() != model.axisCount()) {
        return invalid(
            fmt::format("{}: {} values for {} axes", what, values.size(), model.axisCount()));
    }
    return checkLimitValues(values, what);
}

}  // namespace

Checked checkPtp(const RobotModel& model, const PtpRequest& request) {
    return all({checkPosition(model, request.start, "start", kStartTolerance),
                checkAxisLimits(model, request.max_velocity, "max velocity"),
                checkAxisLimits(model, request.max_acceleration, "max acceleration"),
                checkOverride(request.speed_override), checkBounds(model, request.axis_bounds),
                checkArmAngle(request.redundancy_angle)});
}

Checked checkLin(const RobotModel& model, const LinRequest& request) {
    return all({checkPosition(model, request.start, "start", kStartTolerance),
                checkPose(request.target), checkLimitValues(request.max_velocity, "max velocity"),
                checkLimitValues(request.max_acceleration, "max acceleration"),
                checkOverride(request.speed_override), checkBounds(model, request.axis_bounds),
                checkArmAngle(request.redundancy_angle)});
}

Checked checkPath(const RobotModel& model, const PathRequest& request) {
    METIER_TRY(checkLin(model, request.lin));
    if (request.waypoints.empty()) {
        return invalid("a path needs at least one waypoint");
    }
    for (std::size_t i = 0; i < request.waypoints.size(); ++i) {
        const PathWaypoint& waypoint = request.waypoints[i];
        METIER_TRY(
            all({checkPose(waypoint.target),
                 checkLimitValues(std::array{waypoint.max_velocity, waypoint.max_angular_velocity},
                                  "waypoint velocity")}));
        const bool last = i + 1 == request.waypoints.size();
        if (!last && !(waypoint.blend_radius > 0 && std::isfinite(waypoint.blend_radius))) {
            return invalid(fmt::format("waypoint {}: blend radius {} m is not over 0 m: to stop "
                                       "there, end the path there",
                                       i + 1, waypoint.blend_radius),
                           Errc::out_of_range);
        }
    }
    return {};
}

}  // namespace metier::motion
