#pragma once

#include <algorithm>
#include <cmath>

namespace metier::virtual_controller {

/// Distance along a path from rest to rest: speeds up, drives, brakes. The unit of length is the
/// caller's: m or rad; time is in s.
///
/// Threading: a value; any thread.
///
///     const Trapezoid way(0.5, 1.0, 4.0);        // half a metre, at most 1 m/s and 4 m/s2
///     const double now = way.at(time);           // 0 to 0.5 m
///     const bool done = time >= way.duration();
class Trapezoid {
public:
    /// The arguments are not checked: a velocity or an acceleration of 0 has no meaningful result.
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
    /// It is not compared with the limits of the original one: a short duration exceeds them.
    Trapezoid lasting(double duration) const {
        Trapezoid other = *this;
        other.duration_ = duration;
        other.ramp_ = duration / 3.0;
        other.velocity_ = length_ / (duration - other.ramp_);
        other.acceleration_ = other.velocity_ / other.ramp_;
        return other;
    }

    /// Distance from the start; 0 before the begin, `length` after the end.
    /// Continuous in position and velocity; the acceleration jumps at the ends of the three parts.
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
    /// 0 for a length of 0.
    double duration() const { return duration_; }
    /// Time at which it begins to brake [s].
    /// A shorter length than the ramps need has no part of constant velocity: it is then half of
    /// duration().
    double brakingFrom() const { return duration_ - ramp_; }

private:
    // Velocity and acceleration are those that are really driven: velocity_ is below the given
    // limit if the length is too short to reach it.
    double length_;
    double velocity_;
    double acceleration_;
    double ramp_;  // [s]
    double duration_ = 0.0;
};

}  // namespace metier::virtual_controller
