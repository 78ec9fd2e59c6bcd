#include <chrono>
#include <cmath>
#include <memory>

#include "wsg50_gripper.hpp"

namespace metier::wsg50_driver {
namespace {

std::chrono::milliseconds milliseconds(double seconds) {
    return std::chrono::milliseconds(std::llround(seconds * 1e3));
}

std::optional<double> optionalNumber(const cell::Settings& settings, std::string_view name,
                                     double low, double high) {
    return settings.has(name) ? std::optional(settings.numberOr(name, low, low, high))
                              : std::nullopt;
}

Result<device::OpenDevice> open(const device::OpenRequest& request) {
    METIER_ASSIGN(auto options, readOptions(request));
    auto gripper = std::make_shared<Wsg50Gripper>(std::move(options));
    device::OpenDevice device;
    device.gripper = gripper.get();
    device.owner = std::move(gripper);
    return device;
}

}  // namespace

Result<Wsg50Options> readOptions(const device::OpenRequest& request) {
    const auto& settings = request.settings;
    Wsg50Options options;
    options.name = request.name;
    options.host = request.address;
    options.port = static_cast<std::uint16_t>(settings.numberOr("port", options.port, 1, 65535));
    options.speed = settings.numberOr("speed", options.speed, 0.005, 0.42);
    options.grasp_speed = settings.numberOr("grasp_speed", options.grasp_speed, 0.005, 0.42);
    options.part_width = optionalNumber(settings, "part_width", 0.0, 0.21);
    options.force = optionalNumber(settings, "force", 1.0, 120.0);
    options.open_width = optionalNumber(settings, "open_width", 0.0, 0.21);
    auto& conversation = options.conversation;
    conversation.acceleration = settings.numberOr("acceleration", 0.0, 0.0, 10.0);
    conversation.acknowledge = settings.flagOr("acknowledge_on_connect", false);
    conversation.home = settings.flagOr("home_on_connect", false);
    conversation.update_period = milliseconds(settings.numberOr("update_period", 0.02, 0.005, 1.0));
    conversation.silence_periods =
        static_cast<int>(settings.numberOr("silence_periods", 3.0, 2.0, 1000.0));
    conversation.motion_timeout =
        milliseconds(settings.numberOr("motion_timeout", 30.0, 0.1, 300.0));
    return settings.finish().map([&] { return options; });
}

}  // namespace metier::wsg50_driver

namespace metier::device {

Driver wsg50Driver();

Driver wsg50Driver() {
    return {.name = "wsg50",
            .help = "Weiss WSG 50 grippers: binary commands over TCP, port 1000",
            .open = wsg50_driver::open,
            .port = {"port", 1000}};
}

}  // namespace metier::device
