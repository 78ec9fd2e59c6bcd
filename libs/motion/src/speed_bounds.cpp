#include "speed_bounds.hpp"

#include <algorithm>
#include <cmath>

namespace metier::motion {

namespace {

double larger(double a, double b) noexcept {
    return std::abs(a) > std::abs(b) ? a : b;
}

}  // namespace

SpeedBound between(const SpeedBound& a, const SpeedBound& b) noexcept {
    return {larger(a.first, b.first),
            larger(a.second, b.second),
            larger(a.third, b.third),
            std::max(a.velocity, b.velocity),
            a.acceleration,
            a.jerk,
            a.lengths};
}

std::vector<SpeedBounds> axisBounds(const RobotModel& model, const JointPath& path) {
    std::vector<SpeedBounds> bounds(path.knots().size());
    for (std::size_t k = 0; k < bounds.size(); ++k) {
        const JointDerivatives& d = path.derivatives()[k];
        for (std::size_t i = 0; i < model.axisCount(); ++i) {
            const JointLimits& own = model.limits(i);
            bounds[k].add(
                {d.first[i], d.second[i], d.third[i], own.velocity, own.acceleration, own.jerk});
        }
    }
    return bounds;
}

SpeedBottleneck findBottleneck(const RobotModel& model, const std::vector<SpeedBounds>& bounds,
                               double speed) {
    SpeedBottleneck result;
    for (std::size_t k = 0; k < bounds.size(); ++k) {
        for (std::size_t i = 0; i < model.axisCount(); ++i) {
            const SpeedBound& bound = bounds[k].values[i];
            if (bound.velocity < result.share * speed * std::abs(bound.first)) {
                result = {bound.velocity / std::abs(bound.first) / speed, i, k};
            }
        }
    }
    return result;
}

}  // namespace metier::motion
