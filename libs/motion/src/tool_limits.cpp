#include "tool_limits.hpp"

#include <algorithm>
#include <cmath>

#include "metier/motion/rotation.hpp"

namespace metier::motion {

namespace {

/// Cartesian jerk limit as a multiple of a lowered acceleration limit [1/s].
constexpr double kJerkPerAcceleration = 20.0;

/// A vector of the path, of position or of rotation, and the three limits of its kind.
struct HalfLimits {
    const double* requested = nullptr;  ///< three values
    double own = 0;
    Eigen::Vector3d vector;
};

/// Limit of the path parameter's derivative: of the vector's length where all three limits are
/// equal, else of each component; the robot's own always of the length. Infinite without a length.
double scalarLimit(const HalfLimits& half) {
    const double* r = half.requested;
    if (r[0] == r[1] && r[1] == r[2]) {
        return capped(r[0], half.own) / half.vector.norm();
    }
    double limit = half.own / half.vector.norm();
    for (int i = 0; i < 3; ++i) {
        limit = std::min(limit, capped(r[i], half.own) / std::abs(half.vector[i]));
    }
    return limit;
}

/// The least of three requested values, capped by the robot's own.
double least(const double* three, double own) {
    return capped(three[0], capped(three[1], capped(three[2], own)));
}

/// What the tool frame's translation or rotation may do.
ScalarLimits toolLimits(double velocity, double acceleration, double own_jerk) {
    return {velocity, acceleration, std::min(own_jerk, kJerkPerAcceleration * acceleration)};
}

/// \param d what the tool frame asks of the path parameter
SpeedBound boundOf(const ToolDerivatives& d, const ScalarLimits& limits, double max_velocity) {
    return {d.first, d.second, d.third, max_velocity, limits.acceleration, limits.jerk, true};
}

}  // namespace

ToolLimits toolLimitsOf(const RobotModel& model, const LinRequest& request) {
    const auto ofVector = [](const double* three, double own) {
        const bool alike = three[0] == three[1] && three[1] == three[2];
        return alike ? capped(three[0], own) : own;
    };
    const CartesianLimits& own = model.cartesianLimits();
    const double* v = request.max_velocity.data();
    const double* a = request.max_acceleration.data();
    return {request.speed_override * ofVector(v, own.velocity), ofVector(a, own.acceleration),
            request.speed_override * ofVector(v + 3, own.angular_velocity),
            ofVector(a + 3, own.angular_acceleration)};
}

ToolLimits toolLimitsBetween(const SpeedBounds& a, const SpeedBounds& b, std::size_t axes) {
    const SpeedBound linear = between(a.values[axes], b.values[axes]);
    const SpeedBound angular = between(a.values[axes + 1], b.values[axes + 1]);
    return {linear.velocity, linear.acceleration, angular.velocity, angular.acceleration};
}

double toolExcess(const std::array<Pose, 3>& poses, double step, const ToolLimits& limits) {
    const auto velocity = [&](std::size_t n) -> Eigen::Vector3d {
        return (poses[n + 1].translation - poses[n].translation) / step;
    };
    const auto spin = [&](std::size_t n) -> Eigen::Vector3d {
        return rotationVectorBetween(poses[n].rotation, poses[n + 1].rotation) / step;
    };
    const double acceleration = (velocity(1) - velocity(0)).norm() / step;
    const double angular_acceleration = (spin(1) - spin(0)).norm() / step;
    return std::max({velocity(0).norm() / limits.velocity, spin(0).norm() / limits.angular_velocity,
                     std::sqrt(acceleration / limits.acceleration),
                     std::sqrt(angular_acceleration / limits.angular_acceleration)});
}

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
    limits.jerk = std::min({own.jerk / direction.norm(), own.angular_jerk / turn.norm(),
                            kJerkPerAcceleration * limits.acceleration});
    return limits;
}

double addToolBounds(const RobotModel& model, const PathRequest& request, const JointPath& path,
                     std::vector<SpeedBounds>& bounds) {
    const CartesianLimits& own = model.cartesianLimits();
    const LinRequest& lin = request.lin;
    const double* v = lin.max_velocity.data();
    const double* a = lin.max_acceleration.data();
    const ScalarLimits linear =
        toolLimits(least(v, own.velocity), least(a, own.acceleration), own.jerk);
    const ScalarLimits angular =
        toolLimits(least(v + 3, own.angular_velocity), least(a + 3, own.angular_acceleration),
                   own.angular_jerk);
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
        const SpeedBound t =
            boundOf(path.tool().translationAt(s), linear, lin.speed_override * velocity);
        const SpeedBound r =
            boundOf(path.tool().rotationAt(s), angular, lin.speed_override * angular_velocity);
        fastest = std::max(fastest, std::min(t.velocity / t.first, r.velocity / r.first));
        bounds[k].add(t);
        bounds[k].add(r);
    }
    return fastest;
}

}  // namespace metier::motion
