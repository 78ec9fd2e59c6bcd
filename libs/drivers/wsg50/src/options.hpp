#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "conversation.hpp"
#include "metier/device/driver.hpp"

namespace metier::wsg50_driver {

/// Options of the driver for one gripper.
struct Wsg50Options {
    std::string name;
    std::string host;
    std::uint16_t port = 1000;
    ConversationOptions conversation;
    double speed = 0.1;         ///< speed of moves and releases without a requested speed [m/s]
    double grasp_speed = 0.05;  ///< speed of grasps without a requested speed [m/s]
    /// Width of the part for grasps without a requested width [m]; empty: any width.
    std::optional<double> part_width{};
    std::optional<double> force{};  ///< limit of motions that ask for none [N]; not set: as found
    std::optional<double> open_width{};  ///< width of releases without a requested width [m];
                                         ///< empty: the stroke
};

/// Reads `settings`: port, update_period, silence_periods, speed, grasp_speed, part_width, force,
/// open_width, acceleration, motion_timeout, acknowledge_on_connect, home_on_connect.
/// Errors: invalid_argument for all that is wrong.
Result<Wsg50Options> readOptions(const device::OpenRequest& request);

}  // namespace metier::wsg50_driver
