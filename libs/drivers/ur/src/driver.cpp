#include "metier/device/driver.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <cmath>
#include <memory>
#include <utility>

#include "described_model.hpp"
#include "primary_session.hpp"
#include "ur_arm.hpp"

namespace metier::ur_driver {

namespace {

constexpr int kFirstESeries = 5;  // major version

/// Description that the controller sends; empty if it is not there yet.
ControllerDescription describe(const device::OpenRequest& request, const UrSettings& settings) {
    const auto deadline = std::chrono::steady_clock::now() + settings.open_wait;
    auto description = readDescription(request.address, settings.primary_port, deadline);
    if (!description) {
        spdlog::warn("{}: {}; the model's own kinematics and limits are used", request.name,
                     description.error().message);
        return {};
    }
    return *description;
}

motion::RobotModel modelOf(const device::OpenRequest& request,
                           const ControllerDescription& description) {
    auto model = describedModel(*request.model, description);
    if (!model) {
        spdlog::warn("{}: {}; the model's own kinematics and limits are used", request.name,
                     model.error().message);
        return *request.model;
    }
    return std::move(*model);
}

double frequencyOf(const motion::RobotModel& model, const ControllerDescription& description) {
    if (description.version) {
        return description.version->major < kFirstESeries ? 125.0 : 500.0;
    }
    return std::round(1.0 / model.cycleTime());
}

Result<device::OpenDevice> open(const device::OpenRequest& request) {
    METIER_ASSIGN(auto settings, UrSettings::read(request.settings));
    if (request.model == nullptr || request.model->axisCount() != kAxes) {
        return fail(Errc::invalid_argument,
                    fmt::format("{}: driver ur needs the model of an arm with {} axes",
                                request.name, kAxes));
    }
    const auto description = describe(request, settings);
    auto model = modelOf(request, description);
    if (settings.frequency == 0.0) {
        settings.frequency = frequencyOf(model, description);
    }
    const auto max_velocity =
        description.configuration ? description.configuration->max_velocity : Joints{};
    auto arm = std::make_shared<UrArm>(
        UrArmOptions{request.name, request.address, model, settings, max_velocity});
    device::OpenDevice device;
    device.arm = arm.get();
    device.owner = std::move(arm);
    device.model = std::move(model);
    return device;
}

}  // namespace

}  // namespace metier::ur_driver

namespace metier::device {

Driver urDriver();

Driver urDriver() {
    return {"ur",
            "Universal Robots CB3 and e-Series, by RTDE and a script for servoj",
            ur_driver::open,
            {"rtde_port", 30004}};
}

}  // namespace metier::device
