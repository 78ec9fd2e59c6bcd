#pragma once

#include "metier/motion/profile.hpp"

namespace metier::motion {

/// Brings a planned motion to rest by slowing down its planned time: the pace, planned time per
/// real time, falls smoothly from 1 to 0 in a given time.
///
/// Motions that begin to brake at the same planned time with the same length come to rest at the
/// same planned time, whatever their paths, speeds and limits are.
/// Threading: a value; nothing allocates, locks or throws.
class PaceBrake {
public:
    /// \param length time until rest [s], > 0
    explicit PaceBrake(double length) noexcept : length_(length) {}

    /// Advances by `step` [s] of real time, >= 0.
    /// \return planned time that passes meanwhile [s], at most half of `length` altogether
    double advance(double step) noexcept;
    /// Slows the planned state of the present planned time to the present pace: the position stays,
    /// velocity and acceleration become those in real time.
    ScalarState slowed(const ScalarState& planned) const noexcept;
    /// Whether the pace is 0.
    bool over() const noexcept { return elapsed_ >= length_; }
    /// Time until the pace is 0 [s].
    double remaining() const noexcept { return over() ? 0.0 : length_ - elapsed_; }

private:
    double planned() const noexcept;

    double length_;
    double elapsed_ = 0;
};

}  // namespace metier::motion
