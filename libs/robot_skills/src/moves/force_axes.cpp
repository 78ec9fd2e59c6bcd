#include "moves/force_axes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "metier/base/numbers.hpp"

namespace metier::robot_skills {

namespace {

constexpr int kForceSamples = 20;
constexpr double kSameAxis = 1.0 * kDegree;

Eigen::Matrix3d baseFromFlange(const motion::RobotModel& model, const motion::JointVector& joints) {
    return model.kinematics().forward(joints).rotation.toRotationMatrix();
}

/// The angle between a base axis and a flange axis, as lines.
double angleBetween(const Eigen::Matrix3d& base_from_flange, int base, int flange) {
    return std::acos(std::min(1.0, std::abs(base_from_flange(base, flange))));
}

int nearestFlangeAxis(const Eigen::Matrix3d& base_from_flange, int base) {
    Eigen::Index nearest = 0;
    base_from_flange.row(base).cwiseAbs().maxCoeff(&nearest);
    return static_cast<int>(nearest);
}

}  // namespace

Result<device::ForceCondition> flangeCondition(const motion::RobotModel& model,
                                               const motion::Trajectory& trajectory,
                                               const skill::Vector3& max_force) {
    const std::array limits{max_force.x, max_force.y, max_force.z};
    const auto at_start = baseFromFlange(model, trajectory.start());
    device::ForceCondition condition;
    for (int base = 0; base < 3; ++base) {
        const double limit = limits[static_cast<std::size_t>(base)];
        if (limit == 0.0) {
            continue;
        }
        const int flange = nearestFlangeAxis(at_start, base);
        for (int i = 0; i <= kForceSamples; ++i) {
            const double fraction = static_cast<double>(i) / kForceSamples;
            const auto there = baseFromFlange(model, trajectory.positionAt(fraction));
            if (const double angle = angleBetween(there, base, flange); angle > kSameAxis) {
                return fail(
                    Errc::not_supported,
                    fmt::format("MaxForce along {} of the base frame: at {:.0f} % of the "
                                "path the nearest axis of the flange is {:.1f} deg from "
                                "it, limit {:.0f} deg; the controller watches the "
                                "flange's axes only",
                                "xyz"[base], 100 * fraction, angle / kDegree, kSameAxis / kDegree));
            }
        }
        condition.force[static_cast<std::size_t>(flange)] = limit;
    }
    return condition;
}

}  // namespace metier::robot_skills
