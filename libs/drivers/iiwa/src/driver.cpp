#include "metier/device/driver.hpp"

#include <cmath>

#include "metier/iiwa_driver/iiwa_arm.hpp"

namespace metier::iiwa_driver {

namespace {

std::chrono::nanoseconds milliseconds(double ms) {
    return std::chrono::round<std::chrono::nanoseconds>(
        std::chrono::duration<double, std::milli>(ms));
}

/// Reads the settings and notes errors in them; finish() reports these.
IiwaOptions read(const device::OpenRequest& request) {
    const auto& settings = request.settings;
    IiwaOptions options;
    options.name = request.name;
    options.address = request.address;
    options.port = static_cast<std::uint16_t>(settings.numberOr("port", 12225, 0, 65535));
    const auto precision = settings.textOr("precision", "single");
    if (precision != "single" && precision != "double") {
        settings.reject("precision", "is neither \"single\" nor \"double\"");
    }
    options.precision = precision == "double" ? Precision::float64 : Precision::float32;
    options.cycle = milliseconds(settings.numberOr("poll_period_ms", 10, 1, 1000));
    options.answer_timeout = milliseconds(settings.numberOr("answer_timeout_ms", 100, 5, 10'000));
    options.tool = static_cast<int>(std::lround(settings.numberOr("tool", -1, -1, 1000)));
    options.force_tolerance = settings.numberOr("force_tolerance", 10, 0.1, 1000);
    return options;
}

Result<device::OpenDevice> open(const device::OpenRequest& request) {
    const auto options = read(request);
    METIER_TRY(request.settings.finish());
    if (request.model == nullptr) {
        return fail(Errc::invalid_argument, request.name + ": an iiwa needs a model");
    }
    METIER_ASSIGN(auto arm, IiwaArm::create(options, *request.model));
    // Shared, as OpenDevice asks for.
    const std::shared_ptr<IiwaArm> owner = std::move(arm);
    device::OpenDevice device;
    device.owner = owner;
    device.arm = owner.get();
    device.planner = owner.get();
    device.force_torque_sensor = &owner->flangeForce();
    return device;
}

}  // namespace

}  // namespace metier::iiwa_driver

namespace metier::device {

Driver iiwaDriver();

Driver iiwaDriver() {
    return {"iiwa",
            "KUKA LBR iiwa whose cabinet runs the robot application of libiiwa and dials in (TCP)",
            iiwa_driver::open,
            {"port", 12225}};
}

}  // namespace metier::device
