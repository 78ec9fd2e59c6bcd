#pragma once

#include <algorithm>
#include <cmath>

namespace metier::virtual_controller {

/// Distance along a path from rest to rest: speeds up, drives, brakes. The unit of length is the
/// caller's: m or rad; time is in s.
///
/// Threading: a value; any thread.
class Trapezoid {
public:
    /// \param length       >= 0
    /// \param velocity     largest, > 0; a short length does not reach it
    /// \param acceleration > 0
    Trapezoid(double length, double velocity, double acceleration)
        : length_(length),
          velocity_(velocity),
          acceleration_(acceleration),
          ramp_(velocity / acceleration) {
        if (length_ < velocity_ * ramp_) {
            ramp_ = std::sqrt(length_ / acceleration_);
            velocity_ = acceleration_ * ramp_;
        }
        duration_ = velocity_ > 0.0 ? ramp_ + length_ / velocity_ : 0.0;
    }

    /// The distance with other limits: in the given time [s], > 0, a third of it for each part.
    Trapezoid lasting(double duration) const {
        Trapezoid other = *this;
        other.duration_ = duration;
        other.ramp_ = duration / 3.0;
        other.velocity_ = length_ / (duration - other.ramp_);
        other.acceleration_ = other.velocity_ / other.ramp_;
        return other;
    }

    /// Distance from the start; 0 before the begin, `length` after the end.
    /// \param time [s] since the start
    double at(double time) const {
        const double t = std::clamp(time, 0.0, duration_);
        const double left = duration_ - t;
        if (t < ramp_) {
            return 0.5 * acceleration_ * t * t;
        }
        return left < ramp_ ? length_ - 0.5 * acceleration_ * left * left
                            : velocity_ * (t - 0.5 * ramp_);
    }
    /// Time from start to rest [s].
    double duration() const { return duration_; }
    /// Time at which it begins to brake [s].
    double brakingFrom() const { return duration_ - ramp_; }

private:
    double length_;
    double velocity_;
    double acceleration_;
    double ramp_;  // [s]
    double duration_ = 0.0;
};

}  // namespace metier::virtual_controller
