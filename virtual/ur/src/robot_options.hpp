#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <string_view>

#include "arm.hpp"
#include "metier/base/error.hpp"
#include "metier/cell/settings.hpp"
#include "primary_packages.hpp"
#include "robot_modes.hpp"

namespace metier::virtual_ur {

/// A service with its TCP port.
struct Service {
    std::string_view name;
    std::uint16_t usual_port;
};

inline constexpr std::array kServices{Service{"dashboard", 29999},
                                      Service{"primary", 30001},
                                      Service{"secondary", 30002},
                                      Service{"realtime", 30003},
                                      Service{"rtde", 30004},
                                      Service{"primary_read_only", 30011},
                                      Service{"secondary_read_only", 30012},
                                      Service{"realtime_read_only", 30013}};

/// Right of scripts and the dashboard to command an e-Series arm.
enum class Control : std::uint8_t { local, remote };

/// One virtual robot with its controller.
struct RobotOptions {
    RobotDescription description;
    ArmOptions arm;
    ModeTimes times;
    PowerAtStart power = PowerAtStart::running;
    Control control = Control::remote;
    std::string serial_number;
    std::string robot_model;         ///< answer of the dashboard, such as "UR5"
    std::filesystem::path programs;  ///< folder of what the dashboard loads; empty: none
    std::array<std::uint16_t, kServices.size()> ports{};  ///< of kServices; 0: a free one
    std::string address = "127.0.0.1";  ///< the robot's own, where its sockets come from
};

/// \param model model with six axes; must outlive everything that is made with the options
/// Errors: invalid_argument with all errors; README.md lists the settings.
Result<RobotOptions> readOptions(const cell::Settings& settings, const motion::RobotModel& model);

}  // namespace metier::virtual_ur
