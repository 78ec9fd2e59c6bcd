#include "robot_options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <vector>

#include "metier/base/text.hpp"

namespace metier::virtual_ur {

namespace {

using cell::Settings;

// Value of a UR5 in the maker's configuration package (captured stream) [rad/s2].
constexpr double kJointAcceleration = 40.0;
// A UR5 stops from 183 deg/s within 0.244 s (user manual) [rad/s2].
constexpr double kStopDeceleration = 13.0;

/// One size of the maker's arms.
struct ArmSize {
    int number;
    std::int32_t type;  // in the configuration package; docs/protocols/ur.md
    Series oldest;      // the first series that has it
};
constexpr ArmSize kUr5{5, 1, Series::cb3};
constexpr std::array kArmSizes{kUr5,
                               ArmSize{3, 3, Series::cb3},
                               ArmSize{8, 6, Series::e_series},
                               ArmSize{10, 2, Series::cb3},
                               ArmSize{15, 9, Series::e_series},
                               ArmSize{16, 4, Series::e_series},
                               ArmSize{18, 5, Series::e_series},
                               ArmSize{20, 7, Series::e_series},
                               ArmSize{30, 8, Series::e_series}};

/// Size of a model such as "ur10e". Without a known one in its name it counts as a UR5.
ArmSize sizeOf(std::string_view model) {
    const auto name = inUpperCase(model);
    const auto* const named = std::ranges::find_if(kArmSizes, [&](const ArmSize& size) {
        const auto text = fmt::format("UR{}", size.number);
        const auto begin = name.find(text);
        return begin != std::string::npos &&
               name.find_first_of("0123456789", begin + text.size()) != begin + text.size();
    });
    return named == kArmSizes.end() ? kUr5 : *named;
}

Series readSeries(const Settings& settings, const motion::RobotModel& model) {
    const bool e_series =
        model.name().ends_with("e") || sizeOf(model.name()).oldest == Series::e_series;
    const auto text = settings.textOr("series", e_series ? "e" : "cb3");
    if (text != "e" && text != "cb3") {
        settings.reject("series", "is neither \"cb3\" nor \"e\"");
    }
    return text == "e" ? Series::e_series : Series::cb3;
}

ArmOptions readArm(const Settings& settings, const motion::RobotModel& model, Series series) {
    ArmOptions arm;
    arm.cycle = series == Series::e_series ? 0.002 : 0.008;
    const double acceleration =
        settings.numberOr("joint_acceleration", kJointAcceleration, 0.1, 1000.0);
    arm.stop_deceleration = settings.numberOr("stop_deceleration", kStopDeceleration, 0.1, 1000.0);
    for (std::size_t i = 0; i < kAxes; ++i) {
        const auto& limits = model.limits(i);
        arm.limits.push_back({limits.lower, limits.upper, limits.velocity, acceleration});
    }
    const std::vector<double> home(model.home().begin(), model.home().end());
    const auto start = settings.numbersOr("start", home, kAxes);
    std::copy_n(start.begin(), std::min(start.size(), kAxes), arm.start.begin());
    for (std::size_t i = 0; i < kAxes; ++i) {
        if (arm.start[i] < arm.limits[i].lower || arm.start[i] > arm.limits[i].upper) {
            settings.reject("start",
                            fmt::format("axis {}: {} rad is outside [{:.4f}, {:.4f}] rad", i + 1,
                                        arm.start[i], arm.limits[i].lower, arm.limits[i].upper));
        }
    }
    return arm;
}

RobotDescription describe(const motion::RobotModel& model, const ArmOptions& arm, Series series) {
    RobotDescription description;
    description.series = series;
    const bool e_series = series == Series::e_series;
    description.version =
        e_series ? ControllerVersion{5, 12, 6, 1102099} : ControllerVersion{3, 15, 8, 106339};
    description.build_date = e_series ? "23-03-2023, 12:00:00" : "12-10-2021, 12:00:00";
    description.model = &model;
    description.robot_type = sizeOf(model.name()).type;
    for (std::size_t i = 0; i < kAxes; ++i) {
        description.joint_acceleration[i] = arm.limits[i].acceleration;
    }
    return description;
}

std::string upperCase(std::string_view name) {
    return inUpperCase(name.substr(0, name.size() - (name.ends_with("e") ? 1 : 0)));
}

}  // namespace

Result<RobotOptions> readOptions(const Settings& settings, const motion::RobotModel& model) {
    if (model.axisCount() != kAxes) {
        return fail(Errc::invalid_argument,
                    fmt::format("a UR controller moves 6 axes, model {} has {}", model.name(),
                                model.axisCount()));
    }
    RobotOptions options;
    const Series series = readSeries(settings, model);
    options.arm = readArm(settings, model, series);
    options.description = describe(model, options.arm, series);
    const ModeTimes usual;
    options.times.power_on = settings.numberOr("power_on_time", usual.power_on, 0.0, 60.0);
    options.times.brake_release =
        settings.numberOr("brake_release_time", usual.brake_release, 0.0, 60.0);
    options.times.unlock_delay = settings.numberOr("unlock_delay", usual.unlock_delay, 0.0, 60.0);
    options.power = settings.flagOr("powered", true) ? PowerAtStart::running : PowerAtStart::off;
    options.control = settings.flagOr("remote_control", true) ? Control::remote : Control::local;
    options.serial_number = settings.textOr("serial_number", "20195599999");
    options.robot_model = settings.textOr("robot_model", upperCase(model.name()));
    options.programs = settings.textOr("programs", "");
    std::ranges::transform(kServices, options.ports.begin(), [&](const Service& service) {
        const auto name = fmt::format("{}_port", service.name);
        return static_cast<std::uint16_t>(settings.numberOr(name, service.usual_port, 0, 65'535));
    });
    return settings.finish().map([&] { return options; });
}

}  // namespace metier::virtual_ur
