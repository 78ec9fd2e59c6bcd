#pragma once

#include <chrono>
#include <cstdint>

#include "metier/base/error.hpp"
#include "metier/cell/settings.hpp"

namespace metier::ur_driver {

/// Settings of the connection to one controller. Names, units and ranges:
/// docs/protocols/ur.md#settings.
struct UrSettings {
    enum class PowerOn : std::uint8_t { by_a_person, by_reset };

    std::uint16_t rtde_port = 30004;
    std::uint16_t primary_port = 30001;
    std::uint16_t secondary_port = 30002;
    std::uint16_t dashboard_port = 29999;
    double frequency = 0.0;  ///< rate of the set-points [Hz]; 0: the controller's highest
    double servoj_gain = 300.0;
    double servoj_lookahead = 0.1;   ///< [s]
    double stop_deceleration = 4.0;  ///< [rad/s2]
    std::int32_t register_base = 24;
    PowerOn power_on = PowerOn::by_a_person;
    std::chrono::nanoseconds link_timeout{};  ///< 0: three cycles
    /// Longest silence of the set-points that the script accepts.
    std::chrono::nanoseconds receive_timeout = std::chrono::milliseconds(100);
    /// Longest time from the upload of the script to the first set-point taken.
    std::chrono::nanoseconds start_timeout = std::chrono::seconds(3);
    std::chrono::nanoseconds unlock_delay = std::chrono::seconds(5);
    std::chrono::nanoseconds open_wait = std::chrono::seconds(3);
    double standstill_speed = 0.005;  ///< below it an axis counts as standing [rad/s]
    double follow_tolerance = 0.05;   ///< largest deviation of target_q from the set-points [rad]

    /// Period of the set-points; the frequency must be known.
    std::chrono::nanoseconds cycle() const noexcept {
        return std::chrono::nanoseconds(static_cast<std::int64_t>(1e9 / frequency));
    }

    /// Asks for every setting and calls finish().
    /// Errors: invalid_argument with everything that is wrong.
    static Result<UrSettings> read(const cell::Settings& settings);
};

}  // namespace metier::ur_driver
