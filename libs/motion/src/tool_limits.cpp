#include "tool_limits.hpp"

#include <algorithm>
#include <cmath>

#include "metier/base/numbers.hpp"

namespace metier::motion {

namespace {

/// Cartesian jerk limit as a multiple of a lowered acceleration limit [1/s].
constexpr double kJerkPerAcceleration = 20.0;

/// Largest change of the path parameter at which `vector` changes by no more than `limit`.
double perLength(double limit, const Eigen::Vector3d& vector) {
    const double length = vector.norm();
    if (length == 0) {
        return kInfinity;
    }
    return limit / length;
}

/// A vector of the path, of position or of rotation, and the three limits of its kind.
struct HalfLimits {
    const double* requested = nullptr;  ///< three values
    double own = 0;
    Eigen::Vector3d vector;
};

/// Limit of the path parameter's derivative: of the vector's length where all three limits are
/// equal, else of each component; the robot's own always of the length.
double scalarLimit(const HalfLimits& half) {
    const double length = half.vector.norm();
    if (length == 0) {
        return kInfinity;
    }
    const double* r = half.requested;
    double limit = half.own / length;
    if (r[0] == r[1] && r[1] == r[2]) {
        return std::min(limit, capped(r[0], half.own) / length);
    }
    for (int i = 0; i < 3; ++i) {
        const double component = std::abs(half.vector[i]);
        limit = component > 0 ? std::min(limit, capped(r[i], half.own) / component) : limit;
    }
    return limit;
}

/// The tool frame's translation or rotation: what it may do and asks of the path parameter.
struct ToolBound {
    double velocity = 0;
    double acceleration = 0;
    double jerk = 0;

    SpeedBound at(const ToolDerivatives& d, double max_velocity) const noexcept {
        return {d.first, d.second, d.third, max_velocity, acceleration, jerk, true};
    }
};

/// The least of three requested values, capped by the robot's own.
double least(const double* three, double own) {
    return capped(three[0], capped(three[1], capped(three[2], own)));
}

ToolBound toolBound(double velocity, double acceleration, double own_jerk) {
    return {velocity, acceleration, std::min(own_jerk, kJerkPerAcceleration * acceleration)};
}

double speedAt(const SpeedBound& bound) {
    if (bound.first <= 0) {
        return kInfinity;
    }
    return bound.velocity / bound.first;
}

}  // namespace

ScalarLimits limitsOfLine(const RobotModel& model, const LinRequest& request,
                          const ToolPath& line) {
    const Eigen::Vector3d direction = line.direction();
    const Eigen::Vector3d turn = line.turn();
    const CartesianLimits& own = model.cartesianLimits();
    const double* v = request.max_velocity.data();
    const double* a = request.max_acceleration.data();
    ScalarLimits limits;
    limits.velocity =
        request.speed_override * std::min(scalarLimit({v, own.velocity, direction}),
                                          scalarLimit({v + 3, own.angular_velocity, turn}));
    limits.acceleration = std::min(scalarLimit({a, own.acceleration, direction}),
                                   scalarLimit({a + 3, own.angular_acceleration, turn}));
    const double own_jerk =
        std::min(perLength(own.jerk, direction), perLength(own.angular_jerk, turn));
    limits.jerk = std::min(own_jerk, kJerkPerAcceleration * limits.acceleration);
    return limits;
}

double addToolBounds(const RobotModel& model, const PathRequest& request, const JointPath& path,
                     std::vector<SpeedBounds>& bounds) {
    const CartesianLimits& own = model.cartesianLimits();
    const LinRequest& lin = request.lin;
    const double* v = lin.max_velocity.data();
    const double* a = lin.max_acceleration.data();
    const ToolBound linear =
        toolBound(least(v, own.velocity), least(a, own.acceleration), own.jerk);
    const ToolBound angular = toolBound(least(v + 3, own.angular_velocity),
                                        least(a + 3, own.angular_acceleration), own.angular_jerk);
    double fastest = 0;
    for (std::size_t k = 0; k < bounds.size(); ++k) {
        const double s = path.places()[k];
        double velocity = linear.velocity;
        double angular_velocity = angular.velocity;
        // At the border of two lines the slower one counts.
        for (const double beside : {path.places()[k == 0 ? 0 : k - 1],
                                    path.places()[std::min(k + 1, bounds.size() - 1)]}) {
            const double near = s + 1e-3 * (beside - s);
            const PathWaypoint& waypoint = request.waypoints[path.tool().lineAt(near)];
            velocity = capped(waypoint.max_velocity, velocity);
            angular_velocity = capped(waypoint.max_angular_velocity, angular_velocity);
        }
        const SpeedBound t = linear.at(path.tool().translationAt(s), lin.speed_override * velocity);
        const SpeedBound r =
            angular.at(path.tool().rotationAt(s), lin.speed_override * angular_velocity);
        fastest = std::max(fastest, std::min(speedAt(t), speedAt(r)));
        bounds[k].add(t);
        bounds[k].add(r);
    }
    return fastest;
}

}  // namespace metier::motion
