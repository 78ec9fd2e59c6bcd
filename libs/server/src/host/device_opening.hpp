#pragma once

#include <span>
#include <string>

#include "metier/base/error.hpp"
#include "metier/cell/cell.hpp"
#include "metier/device/driver.hpp"
#include "metier/motion/robot_model.hpp"

namespace metier::server {

/// Server for which a device is opened.
struct DeviceUser {
    const std::string& name;                    ///< name of the server, for messages
    std::span<const device::Driver> drivers;    ///< known drivers
    const motion::RobotModel* model = nullptr;  ///< model of an arm; must outlive the device
};

/// Opens the device that a cell file names.
/// Errors: invalid_argument (unknown driver with the known ones, settings),
///         already_exists (another process of this machine has the device; names its pid).
Result<device::OpenDevice> openDevice(const cell::DriverChoice& choice, const DeviceUser& user);

/// Waits until the device is ready: at most 10 s for its controller's answer, and 2 s more for its
/// safety state to be normal. Logs why it is not.
void awaitConnection(const device::OpenDevice& device);

}  // namespace metier::server
