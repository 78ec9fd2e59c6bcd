#pragma once

#include <array>
#include <cstddef>

#include "metier/device/joint_array.hpp"

namespace metier::joint_simulator {

/// Most cycles of dead time that the simulated arm may have.
inline constexpr std::size_t kMaxDelayCycles = 31;

/// How the measured arm follows the commanded one: a dead time, then a first-order lag.
///
/// Threading: one thread, the cycle. Does not allocate.
class Lag {
public:
    /// \param delay_cycles  dead time, <= kMaxDelayCycles
    /// \param time_constant of the first-order lag [s]; 0: none
    /// \param cycle         [s], > 0
    Lag(std::size_t delay_cycles, double time_constant, double cycle) noexcept;

    /// Puts the arm here, standing.
    void reset(const device::JointArray& position) noexcept;

    /// One cycle in which `commanded` was the set-point.
    void advance(const device::JointArray& commanded) noexcept;

    const device::JointArray& position() const noexcept { return position_; }  ///< measured [rad]
    const device::JointArray& velocity() const noexcept { return velocity_; }  ///< [rad/s]

private:
    std::size_t delay_cycles_;
    double share_;  // of the remaining way that is made good in one cycle
    double cycle_;
    std::array<device::JointArray, kMaxDelayCycles + 1> past_{};
    std::size_t newest_ = 0;
    device::JointArray position_;
    device::JointArray velocity_;
};

}  // namespace metier::joint_simulator
