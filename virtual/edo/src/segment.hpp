#pragma once

#include <vector>

#include "axes.hpp"

namespace metier::virtual_edo {

/// Progress of a motion along a path from 0 to 1: speeds up, goes on, slows down.
class SpeedProfile {
public:
    /// \param velocity     largest [1/s], > 0
    /// \param acceleration [1/s2], > 0
    SpeedProfile(double velocity, double acceleration);

    double at(double seconds) const;
    double duration() const { return 2.0 * ramp_ + cruise_; }
    /// Time at which it begins to slow down [s].
    double brakingFrom() const { return ramp_ + cruise_; }

private:
    double acceleration_;
    double ramp_;
    double cruise_ = 0.0;
};

/// One move of all axes along a path of joint positions.
class Segment {
public:
    /// \param path at least two positions, evenly spaced along the way
    Segment(std::vector<AxisValues> path, SpeedProfile profile);

    AxisValues at(double seconds) const;
    const AxisValues& start() const { return path_.front(); }
    const AxisValues& end() const { return path_.back(); }
    double duration() const { return profile_.duration(); }
    double brakingFrom() const { return profile_.brakingFrom(); }

private:
    std::vector<AxisValues> path_;
    SpeedProfile profile_;
};

}  // namespace metier::virtual_edo
