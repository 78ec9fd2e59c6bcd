#pragma once

#include <cstdint>

#include "metier/device/arm.hpp"
#include "metier/skill/execution_handle.hpp"

namespace metier::robot_skills {

/// Waits after the last set-point until the measured arm stands there. An arm that is late, as on a
/// busy machine, is waited for as long as it moves, 10 s at most; one that rests elsewhere 2 s.
///
/// Threading: one thread, the cycle; tellOffTarget() after it.
class Settling {
public:
    enum class Status : std::uint8_t {
        waiting,     ///< hold the set-point
        arrived,     ///< the arm stands at it
        off_target,  ///< it still is not there when it should long have been
    };

    /// Takes the arm's state, once per cycle.
    /// \param target the last set-point [rad]
    /// \param cycle  [s]
    Status take(const device::ArmState& state, const device::JointArray& target,
                double cycle) noexcept;

    /// Ready for the next end of a motion.
    void restart() noexcept {
        waited_ = rested_ = 0.0;
        arrived_cycles_ = 0;
    }

    /// Fails `execution` with how far off the arm is.
    void tellOffTarget(const skill::ExecutionHandle& execution) const;

private:
    double waited_ = 0.0;     ///< [s]
    double rested_ = 0.0;     ///< time at standstill elsewhere, without a break [s]
    int arrived_cycles_ = 0;  ///< without a break
    double distance_ = 0.0;   ///< largest distance of an axis [rad]
};

}  // namespace metier::robot_skills
