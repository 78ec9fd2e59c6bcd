#include "ur_settings.hpp"

#include <cmath>
#include <string_view>

namespace metier::ur_driver {

namespace {

constexpr std::int32_t kHighestBase = 42;  // registers 0 to 47, a position needs six

std::int32_t wholeNumber(const cell::Settings& settings, std::string_view name,
                         std::int32_t fallback, std::int32_t high) {
    const double number = settings.numberOr(name, fallback, 0.0, high);
    if (number != std::floor(number)) {
        settings.reject(name, "must be a whole number");
    }
    return static_cast<std::int32_t>(number);
}

std::uint16_t port(const cell::Settings& settings, std::string_view name, std::uint16_t fallback) {
    return static_cast<std::uint16_t>(wholeNumber(settings, name, fallback, 65535));
}

std::chrono::nanoseconds seconds(double time) {
    return std::chrono::nanoseconds(static_cast<std::int64_t>(std::llround(1e9 * time)));
}

}  // namespace

Result<UrSettings> UrSettings::read(const cell::Settings& settings) {
    UrSettings read;
    read.rtde_port = port(settings, "rtde_port", read.rtde_port);
    read.primary_port = port(settings, "primary_port", read.primary_port);
    read.secondary_port = port(settings, "secondary_port", read.secondary_port);
    read.dashboard_port = port(settings, "dashboard_port", read.dashboard_port);
    if (settings.has("frequency")) {
        read.frequency = settings.numberOr("frequency", 125.0, 10.0, 500.0);
    }
    read.servoj_gain = settings.numberOr("servoj_gain", 300.0, 100.0, 2000.0);
    read.servoj_lookahead = settings.numberOr("servoj_lookahead", 0.1, 0.03, 0.2);
    read.stop_deceleration = settings.numberOr("stop_deceleration", 4.0, 0.5, 40.0);
    read.register_base = wholeNumber(settings, "register_base", read.register_base, kHighestBase);
    read.power_on = settings.flagOr("power_on", false) ? PowerOn::by_reset : PowerOn::by_a_person;
    if (settings.has("link_timeout")) {
        read.link_timeout = seconds(settings.numberOr("link_timeout", 0.024, 0.004, 2.0));
    }
    read.receive_timeout = seconds(settings.numberOr("receive_timeout", 0.1, 0.01, 0.2));
    read.start_timeout = seconds(settings.numberOr("start_timeout", 3.0, 0.1, 30.0));
    read.unlock_delay = seconds(settings.numberOr("unlock_delay", 5.0, 0.0, 60.0));
    read.open_wait = seconds(settings.numberOr("open_wait", 3.0, 0.0, 30.0));
    read.standstill_speed = settings.numberOr("standstill_speed", 0.005, 1e-4, 0.1);
    read.follow_tolerance = settings.numberOr("follow_tolerance", 0.05, 0.001, 1.0);
    METIER_TRY(settings.finish());
    return read;
}

}  // namespace metier::ur_driver
