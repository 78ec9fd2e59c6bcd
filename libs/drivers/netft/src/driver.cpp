#include <algorithm>
#include <cmath>
#include <memory>

#include "netft_sensor.hpp"

namespace metier::netft_driver {
namespace {

constexpr double kSilentPeriods = 5.0;
constexpr double kShortestSilence = 0.02;  // [s]

std::chrono::milliseconds milliseconds(double seconds) {
    return std::chrono::milliseconds(std::llround(seconds * 1e3));
}

std::optional<double> numberIfSet(const cell::Settings& settings, std::string_view name,
                                  double least, double most) {
    return settings.has(name) ? std::optional(settings.numberOr(name, least, least, most))
                              : std::nullopt;
}

std::uint16_t portOr(const cell::Settings& settings, std::string_view name,
                     std::uint16_t fallback) {
    return static_cast<std::uint16_t>(settings.numberOr(name, fallback, 1, 65535));
}

/// Counts by setting: both, or none.
std::optional<Calibration> givenCalibration(const cell::Settings& settings) {
    const bool force = settings.has("counts_per_force");
    const bool torque = settings.has("counts_per_torque");
    if (!force && !torque) {
        return std::nullopt;
    }
    if (force != torque) {
        settings.reject(force ? "counts_per_torque" : "counts_per_force",
                        "missing; counts are given for both or for none");
    }
    return Calibration{1.0 / settings.numberOr("counts_per_force", 1.0, 1e-3, 1e12),
                       1.0 / settings.numberOr("counts_per_torque", 1.0, 1e-3, 1e12)};
}

std::string unitText(const cell::Settings& settings, std::string_view name,
                     Result<double> (*parse)(std::string_view)) {
    auto text = settings.textOr(name, "");
    if (!text.empty()) {
        if (const auto unit = parse(text); !unit) {
            settings.reject(name, unit.error().message);
        }
    }
    return text;
}

Result<device::OpenDevice> open(const device::OpenRequest& request) {
    METIER_ASSIGN(auto options, readOptions(request));
    auto sensor = std::make_shared<NetftSensor>(std::move(options));
    device::OpenDevice device;
    device.force_torque_sensor = sensor.get();
    device.owner = std::move(sensor);
    return device;
}

}  // namespace

Result<NetftOptions> readOptions(const device::OpenRequest& request) {
    const auto& settings = request.settings;
    NetftOptions options;
    options.name = request.name;
    options.host = request.address;
    options.port = portOr(settings, "port", options.port);
    options.http_port = portOr(settings, "http_port", options.http_port);
    options.calibration = givenCalibration(settings);
    options.units = {unitText(settings, "force_unit", forceUnit),
                     unitText(settings, "torque_unit", torqueUnit)};
    options.rate = numberIfSet(settings, "rate", 1.0, 7000.0);
    if (const auto silence = numberIfSet(settings, "silence", 0.001, 5.0)) {
        options.silence = milliseconds(*silence);
    }
    return settings.finish().map([&] { return options; });
}

std::chrono::milliseconds silenceAt(double rate) {
    return milliseconds(std::max(kSilentPeriods / rate, kShortestSilence));
}

}  // namespace metier::netft_driver

namespace metier::device {

Driver netftDriver();

Driver netftDriver() {
    return {.name = "netft",
            .help = "ATI Net F/T force-torque sensors: RDT over UDP, calibration by HTTP",
            .open = netft_driver::open};
}

}  // namespace metier::device
