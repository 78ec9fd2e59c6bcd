#include "plan_fuzz.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "metier/motion/rotation.hpp"
#include "test_robots.hpp"

namespace metier::motion {

using Eigen::Vector3d;
using motion::Pose;

namespace {

constexpr double kTolerance = 1.02;
/// Rounding of a sampled joint position [rad] and of a place of the tool [m], [rad].
constexpr double kRounding = 2e-14;

/// The least of three requested values, capped by the robot's own.
double least(const double* three, double own) {
    for (int i = 0; i < 3; ++i) {
        own = three[i] > 0 ? std::min(own, three[i]) : own;
    }
    return own;
}

/// The robot's own where not all three are the same, since then they bound components.
double ofLine(const double* three, double own) {
    return three[0] == three[1] && three[1] == three[2] ? least(three, own) : own;
}

std::string toString(const LinRequest& request) {
    std::string text =
        fmt::format("override {}, v ({}), a ({}), start (", request.speed_override,
                    fmt::join(request.max_velocity, " "), fmt::join(request.max_acceleration, " "));
    for (const double q : request.start) {
        text += fmt::format("{} ", q);
    }
    return text + ")";
}

std::string toString(const PathWaypoint& waypoint) {
    const Vector3d& t = waypoint.target.translation;
    const Eigen::Quaterniond& r = waypoint.target.rotation;
    return fmt::format("\n  {} {} {}  {} {} {} {}  blend {} v {} w {}", t.x(), t.y(), t.z(), r.w(),
                       r.x(), r.y(), r.z(), waypoint.blend_radius, waypoint.max_velocity,
                       waypoint.max_angular_velocity);
}

}  // namespace

/// Limits of the tool frame.
struct ToolLimits {
    double velocity = std::numeric_limits<double>::infinity();
    double angular_velocity = std::numeric_limits<double>::infinity();
    double acceleration = std::numeric_limits<double>::infinity();
    double angular_acceleration = std::numeric_limits<double>::infinity();
};

double PlanFuzz::between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
}

double PlanFuzz::anySize(double low, double high) {
    return std::exp(between(std::log(low), std::log(high)));
}

Vector3d PlanFuzz::anyDirection() {
    if (oneOf(2)) {
        return (oneOf(2) ? 1 : -1) *
               Vector3d::Unit(std::uniform_int_distribution<int>(0, 2)(random_));
    }
    return Vector3d(between(-1, 1), between(-1, 1), between(-1, 1)).normalized();
}

Pose PlanFuzz::anyStep() {
    Pose step;
    const int kind = std::uniform_int_distribution<int>(0, 9)(random_);
    if (kind > 0) {
        step.translation = anySize(kind == 1 ? 1e-9 : 1e-4, 0.3) * anyDirection();
    }
    if (kind == 0 || kind >= 6) {
        step.rotation = motion::fromRotationVector(
            (kind == 9 ? std::numbers::pi : anySize(1e-9, 1.0)) * anyDirection());
    }
    return oneOf(200) ? Pose{} : step;
}

JointVector PlanFuzz::anyStart() {
    JointVector start = model_->home();
    for (double& q : start) {
        q += between(-0.4, 0.4);
    }
    return start;
}

void PlanFuzz::limit(LinRequest& request) {
    const CartesianLimits& own = model_->cartesianLimits();
    const auto set = [&](double* three, double most) {
        const double value = oneOf(3) ? 0 : anySize(1e-3, 1.5) * most;
        for (int i = 0; i < 3; ++i) {
            three[i] = oneOf(8) ? anySize(1e-3, 1) * most : value;
        }
    };
    set(request.max_velocity.data(), own.velocity);
    set(request.max_velocity.data() + 3, own.angular_velocity);
    set(request.max_acceleration.data(), own.acceleration);
    set(request.max_acceleration.data() + 3, own.angular_acceleration);
    request.speed_override = oneOf(2) ? 1 : anySize(1e-2, 1);
    request.reference = oneOf(2) ? TargetReference::relative_base : TargetReference::relative_tool;
}

PathRequest PlanFuzz::anyPath() {
    PathRequest request;
    request.lin.start = anyStart();
    limit(request.lin);
    const int count = std::uniform_int_distribution<int>(1, oneOf(10) ? 30 : 6)(random_);
    const bool alike = oneOf(3);
    const double size = anySize(1e-4, 0.1);
    for (int i = 0; i < count; ++i) {
        PathWaypoint waypoint;
        waypoint.target = anyStep();
        if (alike) {
            waypoint.target = {size * (1 + anySize(1e-12, 1e-2)) * anyDirection(), {1, 0, 0, 0}};
        }
        if (i > 0 && oneOf(12)) {  // straight back
            waypoint.target.translation = -request.waypoints.back().target.translation;
            waypoint.target.rotation = request.waypoints.back().target.rotation.conjugate();
        }
        waypoint.max_velocity = oneOf(4) ? anySize(1e-3, 1) : 0;
        waypoint.max_angular_velocity = oneOf(8) ? anySize(1e-2, 1) : 0;
        request.waypoints.push_back(waypoint);
    }
    for (int i = 0; i + 1 < count; ++i) {
        double shorter = std::numeric_limits<double>::infinity();
        double fastest = 0;
        for (const int n : {i, i + 1}) {
            const Pose& step = request.waypoints[static_cast<std::size_t>(n)].target;
            const double way = step.translation.norm();
            const double turn = motion::rotationAngleBetween(Pose{}.rotation, step.rotation);
            const double length = std::max(way, 0.25 * turn);
            shorter = std::min(shorter, length);
            fastest = std::max(fastest, way / std::max(length, 1e-300));
        }
        const double share = oneOf(3) ? 1 : anySize(1e-6, 1);
        constexpr double least = 1.001e-6;  // a smaller corner is refused
        request.waypoints[static_cast<std::size_t>(i)].blend_radius =
            fastest > 0 ? std::max(0.5 * share * shorter, least) * fastest : anySize(1e-6, 0.1);
    }
    return request;
}

PtpRequest PlanFuzz::anyPtp() {
    PtpRequest request;
    request.start = randomPosition(*model_, random_);
    JointVector target = oneOf(2) ? randomPosition(*model_, random_) : request.start;
    request.max_velocity = JointVector(model_->axisCount());
    request.max_acceleration = JointVector(model_->axisCount());
    for (std::size_t i = 0; i < target.size(); ++i) {
        if (oneOf(3)) {
            target[i] = std::clamp(request.start[i] + anySize(1e-12, 0.1), model_->limits(i).lower,
                                   model_->limits(i).upper);
        }
        request.max_velocity[i] = oneOf(2) ? 0 : anySize(1e-4, 1) * model_->limits(i).velocity;
        request.max_acceleration[i] =
            oneOf(2) ? 0 : anySize(1e-4, 1) * model_->limits(i).acceleration;
    }
    request.target = target;
    request.speed_override = oneOf(2) ? 1 : anySize(1e-3, 1);
    return request;
}

std::string PlanFuzz::check(const Planned<Trajectory>& planned, const ToolLimits& tool,
                            const JointVector& start) {
    if (!planned) {
        return {};
    }
    ++planned_;
    const bool slow = oneOf(8);
    const double stretch = slow ? anySize(1, 100) : 1;
    const Trajectory plan = slow ? planned->stretchedTo(stretch * planned->duration()) : *planned;
    const double duration = plan.duration().count();
    if (!std::isfinite(duration) || duration < 0) {
        return fmt::format("duration {}", duration);
    }
    const auto at = [&](double time) { return plan.sample(Seconds(time)).position; };
    if (maxDifference(at(0), start) > 1e-9 || maxDifference(at(duration), plan.end()) > 1e-9) {
        return "does not run from its start to its end";
    }
    // Where the last fifth turns the axes by less than 1e-8 rad, its end is lost in rounding.
    const bool moves = maxDifference(start, plan.end()) > 1e-6;
    const double last_fifth = maxDifference(at(0.8 * duration), plan.end());
    const bool hidden = last_fifth > 1e-12 && last_fifth < 1e-8;
    if (moves && !hidden && maxDifference(at(0.97 * duration), plan.end()) < 1e-13) {
        return "ends before its duration";
    }
    const double step = std::clamp(duration / 200, 1e-4, 1e-3) * between(0.5, 1);
    constexpr int kPlaces = 40;
    for (int place = 0; place < kPlaces; ++place) {
        const double begin = (place + between(0, 1)) / kPlaces * (duration + 4 * step) - 4 * step;
        if (auto fault = checkAt(plan, begin, step, tool); !fault.empty()) {
            return fmt::format("{} at {:.6f} s of {:.6f} s, step {:.6f}, stretched {}", fault,
                               begin, duration, step, stretch);
        }
    }
    return {};
}

std::string PlanFuzz::checkAt(const Trajectory& plan, double begin, double step,
                              const ToolLimits& tool) {
    std::string fault;
    const auto use = [&](const char* what, double value, double limit, double rounding) {
        const double share = (std::abs(value) - rounding) / limit;
        double& most = shares_[what];
        most = std::max(most, share);
        if (!(share <= kTolerance) && fault.empty()) {
            fault = fmt::format("{} {:.4f} of its limit {}", what, share, limit);
        }
    };
    std::array<JointVector, 4> q;
    std::array<Pose, 3> pose;
    for (std::size_t n = 0; n < q.size(); ++n) {
        q[n] = plan.sample(Seconds(begin + static_cast<double>(n) * step)).position;
        if (!q[n].allFinite()) {
            return "not finite";
        }
        if (n < pose.size()) {
            pose[n] = plan.toolPose(q[n]);
        }
    }
    for (std::size_t i = 0; i < q[0].size(); ++i) {
        const JointLimits& own = model_->limits(i);
        const double v = (q[1][i] - q[0][i]) / step;
        const double a = (q[2][i] - 2 * q[1][i] + q[0][i]) / (step * step);
        const double j = (q[3][i] - 3 * q[2][i] + 3 * q[1][i] - q[0][i]) / (step * step * step);
        const double noise = kRounding * 4;
        use("axis velocity", v, own.velocity, noise / step);
        use("axis acceleration", a, own.acceleration, noise / (step * step));
        use("axis jerk", j, own.jerk, 2 * noise / (step * step * step));
    }
    const Vector3d v0 = (pose[1].translation - pose[0].translation) / step;
    const Vector3d v1 = (pose[2].translation - pose[1].translation) / step;
    const Vector3d w0 = motion::rotationVectorBetween(pose[0].rotation, pose[1].rotation) / step;
    const Vector3d w1 = motion::rotationVectorBetween(pose[1].rotation, pose[2].rotation) / step;
    const double noise = kRounding * 8;
    use("tool velocity", v0.norm(), tool.velocity, noise / step);
    use("tool angular velocity", w0.norm(), tool.angular_velocity, noise / step);
    use("tool acceleration", (v1 - v0).norm() / step, tool.acceleration, noise / (step * step));
    use("tool angular acceleration", (w1 - w0).norm() / step, tool.angular_acceleration,
        noise / (step * step));
    return fault;
}

std::string PlanFuzz::next() {
    std::seed_seq seed{seed_, number_++};
    random_.seed(seed);
    model_ = &models_[std::uniform_int_distribution<std::size_t>(0, models_.size() - 1)(random_)];
    const CartesianLimits& own = model_->cartesianLimits();
    const auto report = [&](std::string fault, const std::string& what) {
        return fault.empty() ? fault : fmt::format("{}: {}; {}", model_->name(), fault, what);
    };
    const Planner planner(*model_);
    if (oneOf(4)) {
        const PtpRequest request = anyPtp();
        return report(check(planner.ptp(request), {}, request.start), "PTP");
    }
    const PathRequest request = anyPath();
    LinRequest lin = request.lin;
    const double* v = lin.max_velocity.data();
    const double* a = lin.max_acceleration.data();
    if (request.waypoints.size() == 1 && oneOf(2)) {
        lin.target = request.waypoints[0].target;
        const ToolLimits tool{lin.speed_override * ofLine(v, own.velocity),
                              lin.speed_override * ofLine(v + 3, own.angular_velocity),
                              ofLine(a, own.acceleration), ofLine(a + 3, own.angular_acceleration)};
        return report(check(planner.lin(lin), tool, lin.start),
                      "LIN " + toString(lin) + toString(request.waypoints[0]));
    }
    const ToolLimits tool{lin.speed_override * least(v, own.velocity),
                          lin.speed_override * least(v + 3, own.angular_velocity),
                          least(a, own.acceleration), least(a + 3, own.angular_acceleration)};
    std::string fault = check(planner.path(request), tool, lin.start);
    if (fault.empty()) {
        return fault;
    }
    std::string what =
        fmt::format("reference {}, {}", static_cast<int>(lin.reference), toString(lin));
    for (const PathWaypoint& waypoint : request.waypoints) {
        what += toString(waypoint);
    }
    return report(fault, what);
}

}  // namespace metier::motion
