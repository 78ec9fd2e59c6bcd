#pragma once

#include <array>
#include <cstddef>

#include "metier/device/joint_array.hpp"

namespace metier::joint_simulator {

/// Largest dead time of the simulated arm [cycles].
inline constexpr std::size_t kMaxDelayCycles = 31;

/// Model of a measured arm that follows the commanded one: a dead time, then a first-order lag.
///
/// Threading: one thread, the cycle. Does not allocate.
///
/// In one cycle the arm moves 1 - exp(-cycle / time_constant) of the way that is left. After the
/// dead time it arrives exactly, since the last 1e-9 rad are done at once.
class Lag {
public:
    /// A larger delay is taken as kMaxDelayCycles. Begins without axes: call reset().
    /// \param delay_cycles  dead time, <= kMaxDelayCycles
    /// \param time_constant time constant of the first-order lag [s]; 0: no lag
    /// \param cycle         period [s], > 0
    Lag(std::size_t delay_cycles, double time_constant, double cycle) noexcept;

    /// Sets the arm at a position [rad], standing still.
    /// The dead time is filled with this position: nothing commanded before has an effect.
    void reset(const device::JointArray& position) noexcept;

    /// Advances by one cycle in which `commanded` [rad] was the set-point.
    void advance(const device::JointArray& commanded) noexcept;

    /// Measured position [rad].
    const device::JointArray& position() const noexcept { return position_; }
    /// Measured velocity [rad/s].
    /// Mean over the last cycle.
    const device::JointArray& velocity() const noexcept { return velocity_; }

private:
    std::size_t delay_cycles_;
    double share_;  // share of the remaining way that the arm moves in one cycle
    double cycle_;
    std::array<device::JointArray, kMaxDelayCycles + 1> past_{};
    std::size_t newest_ = 0;
    device::JointArray position_;
    device::JointArray velocity_;
};

}  // namespace metier::joint_simulator
