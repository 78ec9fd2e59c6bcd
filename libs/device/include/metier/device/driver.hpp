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

/// What a driver found at its address. The pointers belong to `owner`, which ends the connection.
struct OpenDevice {
    std::shared_ptr<void> owner;  // shared, since it stands for several faces of one thing
    device::Arm* arm = nullptr;
    device::MotionPlanner* planner = nullptr;
    device::Gripper* gripper = nullptr;
    device::ForceTorqueSensor* force_torque_sensor = nullptr;
    /// The robot as its controller describes it (calibration, limits), if it tells.
    std::optional<motion::RobotModel> model{};
};

/// What a driver is asked to open.
struct OpenRequest {
    std::string name;                  ///< of the server, for messages
    std::string address;               ///< of the controller, without a port
    cell::Settings settings;  ///< the driver's own; it calls finish()
    /// Of the arm, must outlive the device; nullptr for other devices.
    const motion::RobotModel* model = nullptr;
};

/// The setting of a driver that tells controllers behind one address apart.
struct DevicePort {
    std::string_view setting{};  ///< empty: several processes may use the device at a time
    std::uint16_t preset = 0;    ///< without the setting
};

/// One kind of controller that metier can talk to. To add one: docs/guide/add-a-robot.md.
struct Driver {
    std::string_view name;  ///< as in `driver = { type = "ur" }`
    std::string_view help;  ///< one line: maker, controllers, protocol
    /// Begins to connect and goes on by itself: a controller that is not there yet is no error,
    /// only a device whose safety state is disconnected.
    /// Errors: invalid_argument for what is wrong in the settings.
    Result<OpenDevice> (*open)(const OpenRequest& request);
    /// With it one process of this machine at a time has the device.
    DevicePort port{};
};

/// Every driver that was built, by name.
const std::vector<Driver>& drivers();

}  // namespace metier::device
