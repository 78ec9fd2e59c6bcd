#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "metier/cell/settings.hpp"
#include "metier/device/arm.hpp"
#include "metier/device/force_torque_sensor.hpp"
#include "metier/device/gripper.hpp"
#include "metier/device/motion_planner.hpp"
#include "metier/motion/robot_model.hpp"

namespace metier::device {

/// Device that a driver has opened. The pointers are valid as long as `owner`, whose end closes the
/// connection; nullptr: the device has no such interface.
struct OpenDevice {
    std::shared_ptr<void> owner;  // shared by the users of several interfaces of one device
    device::Arm* arm = nullptr;
    device::MotionPlanner* planner = nullptr;
    device::Gripper* gripper = nullptr;
    device::ForceTorqueSensor* force_torque_sensor = nullptr;
    /// Robot as its controller describes it (calibration, limits); empty if it does not.
    std::optional<motion::RobotModel> model{};
};

/// Request to open a device.
struct OpenRequest {
    std::string name;         ///< name of the server, for messages
    std::string address;      ///< address of the controller, without a port
    cell::Settings settings;  ///< settings of the driver, which calls finish()
    /// Model of the arm, must outlive the device; nullptr for other devices.
    const motion::RobotModel* model = nullptr;
};

/// Setting of a driver that distinguishes controllers behind one address, usually the port.
struct DevicePort {
    std::string_view setting{};  ///< empty: several processes may use the device at a time
    std::uint16_t preset = 0;    ///< value if the setting is missing
};

/// One kind of controller that metier can talk to. To add one: docs/guide/add-a-robot.md.
struct Driver {
    std::string_view name;  ///< name in a cell file: `driver = { type = "ur" }`
    std::string_view help;  ///< one line: maker, controllers, protocol
    /// Begins to connect; the device connects, and connects again, on its own thread. A controller
    /// that is not there yet is no error: the device's safety state is disconnected until it is.
    /// Errors: invalid_argument for errors in the settings.
    Result<OpenDevice> (*open)(const OpenRequest& request);
    /// If set, only one process of this machine at a time may have the device.
    DevicePort port{};
};

/// Every driver of this build, sorted by name.
const std::vector<Driver>& drivers();

}  // namespace metier::device
