#include "options.hpp"

#include <cmath>

#include "units.hpp"

namespace metier::edo_driver {
namespace {

// A Halt brakes twice as hard as a motion is planned, and so does the driver.
constexpr double kBrakeReserve = 2.0;
// Degrees to either side.
constexpr std::array<double, 6> kStroke{179, 99, 99, 179, 103.5, 179};

Duration seconds(double value) {
    return std::chrono::round<Duration>(std::chrono::duration<double>(value));
}

/// Without a model: the controller's own configuration (docs/protocols/edo.md#axes).
motion::JointLimits defaultLimits(std::size_t axis) {
    const bool wrist = axis >= 3;
    return {-kStroke[axis] * kRadiansPerDegree, kStroke[axis] * kRadiansPerDegree,
            (wrist ? 33.59 : 22.79) * kRadiansPerDegree, (wrist ? 67.2 : 45.6) * kRadiansPerDegree,
            0.0};
}

void readAxes(const motion::RobotModel* model, EdoOptions& options) {
    const auto count = model != nullptr ? model->axisCount() : options.layout.axes;
    options.layout.axes = count;
    for (std::size_t axis = 0; axis < count; ++axis) {
        auto& limits =
            options.axes.emplace_back(model != nullptr ? model->limits(axis) : defaultLimits(axis));
        limits.acceleration *= kBrakeReserve;
        options.axis_names.push_back(model != nullptr ? model->chain().joints[axis].name
                                                      : fmt::format("J{}", axis + 1));
    }
}

std::optional<Generation> readGeneration(const cell::Settings& settings) {
    const auto text = settings.textOr("generation", "auto");
    if (text == "classic") {
        return classicGeneration();
    }
    if (text == "external") {
        return externalGeneration();
    }
    if (text != "auto") {
        settings.reject("generation", "must be auto, classic or external");
    }
    return std::nullopt;
}

void readGripper(const cell::Settings& settings, GripperOptions& gripper) {
    gripper.stroke = settings.numberOr("stroke", gripper.stroke, 0.001, 0.2);
    gripper.speed = settings.numberOr("gripper_speed", gripper.speed, 0.001, 1.0);
    gripper.grasp_shortfall =
        settings.numberOr("grasp_shortfall_mm", gripper.grasp_shortfall / kMetresPerMillimetre, 0.1,
                          50) *
        kMetresPerMillimetre;
    gripper.grasp_current = settings.numberOr("grasp_current", gripper.grasp_current, 0, 10);
    gripper.timeout = seconds(settings.numberOr("gripper_timeout", 10, 0.1, 120));
}

void readTimes(const cell::Settings& settings, EdoOptions& options) {
    const auto read = [&](std::string_view name, Duration& value, double low, double high) {
        value = seconds(
            settings.numberOr(name, std::chrono::duration<double>(value).count(), low, high));
    };
    read("joint_timeout", options.joint_timeout, 0.03, 10);
    read("machine_timeout", options.machine_timeout, 0.3, 10);
    read("hold_control", options.hold_control, 0.05, 60);
    read("following_time", options.following.time, 0.02, 10);
}

}  // namespace

Result<EdoOptions> readOptions(const device::OpenRequest& request) {
    const auto& settings = request.settings;
    EdoOptions options;
    options.name = request.name;
    options.host = request.address;
    options.port =
        static_cast<std::uint16_t>(std::lround(settings.numberOr("port", options.port, 1, 65535)));
    options.generation = readGeneration(settings);
    options.layout.gripper = settings.flagOr("gripper", options.layout.gripper);
    options.start_on_connect = settings.flagOr("start_on_connect", options.start_on_connect);
    options.following.distance =
        settings.numberOr("following_distance", options.following.distance, 0.001, 3);
    options.reset.steps =
        static_cast<std::uint32_t>(std::lround(settings.numberOr("reset_steps", 2000, 1, 100'000)));
    options.reset.offset = settings.numberOr("reset_offset_deg", 3.5, 0, 10) * kRadiansPerDegree;
    readTimes(settings, options);
    readGripper(settings, options.gripper);
    if (request.model != nullptr && request.model->axisCount() > kMaxJoints - 1) {
        return fail(Errc::invalid_argument,
                    fmt::format("{}: the model has {} axes, an e.DO at most {}", request.name,
                                request.model->axisCount(), kMaxJoints - 1));
    }
    readAxes(request.model, options);
    METIER_TRY(settings.finish());
    return options;
}

}  // namespace metier::edo_driver
