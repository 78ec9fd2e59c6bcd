#pragma once

#include "metier/motion/profile.hpp"

namespace metier::motion {

/// Brings a planned motion to rest by letting its planned time pass ever more slowly: the pace
/// falls smoothly from 1 to 0 in a given time.
///
/// Motions that begin to brake at the same planned time with the same length of the brake stand at
/// the same planned time, whatever their paths, speeds and limits are.
/// Threading: a value; nothing allocates, locks or throws.
class PaceBrake {
public:
    /// \param length time until rest [s], > 0
    explicit PaceBrake(double length) noexcept : length_(length) {}

    /// Lets `step` pass. \return the planned time that passes with it [s]
    double advance(double step) noexcept;
    /// The state planned for the present planned time, slowed to the present pace.
    ScalarState slowed(const ScalarState& planned) const noexcept;
    bool over() const noexcept { return elapsed_ >= length_; }
    double remaining() const noexcept { return over() ? 0.0 : length_ - elapsed_; }  ///< [s]

private:
    double planned() const noexcept;

    double length_;
    double elapsed_ = 0;
};

}  // namespace metier::motion
