#include "segment.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace metier::virtual_edo {

SpeedProfile::SpeedProfile(double velocity, double acceleration)
    : acceleration_(acceleration),
      ramp_(std::min(velocity / acceleration, std::sqrt(1.0 / acceleration))) {
    const double speed = acceleration_ * ramp_;
    cruise_ = std::max(0.0, 1.0 / speed - ramp_);
}

double SpeedProfile::at(double seconds) const {
    const double left = duration() - seconds;
    if (left <= 0.0) {
        return 1.0;
    }
    if (seconds < ramp_) {
        return seconds <= 0.0 ? 0.0 : acceleration_ * seconds * seconds / 2.0;
    }
    if (left < ramp_) {
        return 1.0 - acceleration_ * left * left / 2.0;
    }
    return acceleration_ * ramp_ * (seconds - ramp_ / 2.0);
}

Segment::Segment(std::vector<AxisValues> path, SpeedProfile profile)
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
