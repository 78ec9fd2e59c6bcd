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
/// Made by Driver::open. A copy shares the device with the original.
struct OpenDevice {
    std::shared_ptr<void> owner;  // shared by the users of several interfaces of one device
    /// Interfaces of the device; an arm may have all of them.
    device::Arm* arm = nullptr;
    /// Planner of the arm's controller, for moves that it can run by itself.
    device::MotionPlanner* planner = nullptr;
    /// Gripper, also one at an arm's flange.
    device::Gripper* gripper = nullptr;
    /// Sensor of the wrench, also one that the arm's controller estimates.
    device::ForceTorqueSensor* force_torque_sensor = nullptr;
    /// Robot as its controller describes it (calibration, limits); empty if it does not.
    std::optional<motion::RobotModel> model{};
};

/// Request to open a device.
struct OpenRequest {
    /// Name of the server, for messages.
    std::string name;
    /// Address of the controller without a port: a host name or an IP address.
    std::string address;
    /// Settings of the driver from the cell file. The driver must call finish() after its last key,
    /// so that unknown keys are reported.
    cell::Settings settings;
    /// Model of the arm, must outlive the device; nullptr for other devices.
    const motion::RobotModel* model = nullptr;
};

/// Setting of a driver that distinguishes controllers behind one address, usually the port. Two
/// servers that name the same address and value would command the same device.
struct DevicePort {
    /// Name of the setting; empty: several processes may use the device at a time.
    std::string_view setting{};
    /// Value if the setting is missing.
    std::uint16_t preset = 0;
};

/// One kind of controller that metier can talk to. To add one: docs/guide/add-a-robot.md.
struct Driver {
    /// Name in a cell file, unique: `driver = { type = "ur" }`.
    std::string_view name;
    /// One line: maker, controllers, protocol.
    std::string_view help;
    /// Begins to connect; the device connects, and connects again, on its own thread. A controller
    /// that is not there yet is no error: the device's safety state is disconnected until it is.
    /// Called at the start of a server; may wait for the controller's description of its robot.
    /// Errors: invalid_argument for errors in the settings, or a model that the driver cannot use;
    ///         others as the driver states.
    Result<OpenDevice> (*open)(const OpenRequest& request);
    /// If set, only one process of this machine at a time may have the device.
    DevicePort port{};
};

/// Every driver of this build, sorted by name.
const std::vector<Driver>& drivers();

}  // namespace metier::device
