#include "synchronized/joint_path.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace metier::composition {

namespace {

struct Off {
    std::size_t axis = 0;                                 ///< axis with the largest distance
    double by = std::numeric_limits<double>::infinity();  ///< [rad]
};

Off offPlace(const std::vector<double>& place, const std::vector<double>& now) {
    Off off{0, 0.0};
    for (std::size_t axis = 0; axis < now.size(); ++axis) {
        const double by = std::abs(now[axis] - place[axis]);
        off = by > off.by ? Off{axis, by} : off;
    }
    return off;
}

/// Point nearest to `now` on the line between two places.
std::vector<double> nearest(const std::vector<double>& from, const std::vector<double>& to,
                            const std::vector<double>& now) {
    double along = 0.0;
    double length = 0.0;
    for (std::size_t axis = 0; axis < now.size(); ++axis) {
        along += (now[axis] - from[axis]) * (to[axis] - from[axis]);
        length += (to[axis] - from[axis]) * (to[axis] - from[axis]);
    }
    const double share = length > 0.0 ? std::clamp(along / length, 0.0, 1.0) : 0.0;
    auto place = from;
    for (std::size_t axis = 0; axis < now.size(); ++axis) {
        place[axis] += share * (to[axis] - from[axis]);
    }
    return place;
}

}  // namespace

double brakingTime(const JointPath& path, double duration) {
    constexpr double near_largest = 0.95;
    std::vector<double> steps;  // lengths between neighbours, as speeds are to each other
    for (std::size_t i = 0; i + 1 < path.size(); ++i) {
        steps.push_back(offPlace(path[i], path[i + 1]).by);
    }
    const double largest = steps.empty() ? 0.0 : *std::max_element(steps.begin(), steps.end());
    const auto last_quick = std::find_if(
        steps.rbegin(), steps.rend(), [&](double step) { return step >= near_largest * largest; });
    if (largest <= 0.0) {
        return 0.0;
    }
    const auto slower = static_cast<double>(last_quick - steps.rbegin()) + 1.0;
    return duration * slower / static_cast<double>(steps.size());
}

std::string offPath(const JointPath& path, const std::vector<double>& now) {
    Off least;
    for (std::size_t i = 0; i < path.size(); ++i) {
        const auto& to = path[std::min(i + 1, path.size() - 1)];
        if (path[i].size() != now.size() || to.size() != now.size()) {
            return fmt::format("{} axes instead of {}", now.size(), path[i].size());
        }
        const auto off = offPlace(nearest(path[i], to, now), now);
        least = off.by < least.by ? off : least;
    }
    return least.by <= kOffPath ? ""
                                : fmt::format("axis {} by {:.4f} rad, limit {} rad", least.axis + 1,
                                              least.by, kOffPath);
}

}  // namespace metier::composition
