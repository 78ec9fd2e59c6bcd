#pragma once

#include <chrono>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <vector>

#include "metier/base/clock.hpp"

namespace metier::virtual_controller {

/// For how long a device has been standing, by the clock of this machine: what a real robot's
/// observer sees, whatever its controller says.
class StandingTime {
public:
    /// Less than this is no motion [rad].
    static constexpr double kNoMotion = 1e-4;

    /// Once per cycle. \param position where the device truly is, per axis [rad]
    void take(std::span<const double> position, SteadyTime now);

    /// Since the device moved last, at `now`; zero before the first take().
    std::chrono::duration<double> standing(SteadyTime now) const;
    /// Longest time from one cycle to the next since the device began to move last: what a busy
    /// machine adds to every time that is seen of this controller.
    std::chrono::duration<double> longestCycle() const { return longest_cycle_; }

    /// Adds "standing_for" and "longest_cycle", both [s], to what a controller shows of itself.
    void show(nlohmann::ordered_json& state, SteadyTime now) const;

private:
    std::vector<double> place_;
    SteadyTime moved_{};
    SteadyTime last_{};
    bool moving_ = false;
    std::chrono::duration<double> longest_cycle_{0.0};
};

}  // namespace metier::virtual_controller
