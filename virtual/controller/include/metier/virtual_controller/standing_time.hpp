#pragma once

#include <chrono>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <vector>

#include "metier/base/clock.hpp"

namespace metier::virtual_controller {

/// Time for which a device has been standing still, by the clock of this machine: the view of an
/// observer beside the robot, independent of what its controller reports.
///
/// Threading: one thread, the controller's.
class StandingTime {
public:
    /// Change of position below which nothing counts as motion [rad].
    static constexpr double kNoMotion = 1e-4;

    /// Takes the position; call it once per cycle.
    /// A changed number of axes counts as a motion. The first call sets the place and counts as
    /// none.
    /// \param position true position of each axis [rad]
    /// \param now      time of the cycle, not before that of the last call
    void take(std::span<const double> position, SteadyTime now);

    /// Time from the last motion to `now`; zero before the first take().
    /// While the device moves it is the time since the last cycle that found a change, so about
    /// zero.
    std::chrono::duration<double> standing(SteadyTime now) const;
    /// Longest time from one cycle to the next since the last begin of a motion: a busy machine
    /// adds up to this to every time measured at this controller.
    std::chrono::duration<double> longestCycle() const { return longest_cycle_; }

    /// Adds "standing_for" and "longest_cycle", both [s], to a controller's state.
    void show(nlohmann::ordered_json& state, SteadyTime now) const;

private:
    // Position at the last motion: slow drifts add up to kNoMotion and then count as one.
    std::vector<double> place_;
    SteadyTime moved_{};
    SteadyTime last_{};
    bool moving_ = false;
    std::chrono::duration<double> longest_cycle_{0.0};
};

}  // namespace metier::virtual_controller
