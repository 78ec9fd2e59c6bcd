#include "segment.hpp"

#include <algorithm>
#include <utility>

namespace metier::virtual_edo {

Segment::Segment(std::vector<AxisValues> path, virtual_controller::Trapezoid profile)
    : path_(std::move(path)), profile_(profile) {}

AxisValues Segment::at(double seconds) const {
    const double place = profile_.at(seconds) * static_cast<double>(path_.size() - 1);
    const auto before = std::min(static_cast<std::size_t>(place), path_.size() - 2);
    const double share = place - static_cast<double>(before);
    AxisValues values{};
    for (std::size_t axis = 0; axis < kMostAxes; ++axis) {
        // Exact at both ends.
        values[axis] = path_[before][axis] * (1.0 - share) + path_[before + 1][axis] * share;
    }
    return values;
}

}  // namespace metier::virtual_edo
