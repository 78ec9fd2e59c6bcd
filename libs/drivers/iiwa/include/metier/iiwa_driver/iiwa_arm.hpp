#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include "metier/device/arm.hpp"
#include "metier/device/force_torque_sensor.hpp"
#include "metier/device/motion_planner.hpp"
#include "metier/iiwa_driver/wire.hpp"
#include "metier/motion/robot_model.hpp"

namespace metier::iiwa_driver {

/// Settings of the driver for an iiwa.
struct IiwaOptions {
    /// Name of the arm in messages.
    std::string name = "iiwa";
    /// Address of this computer to which the cabinet connects.
    std::string address = "127.0.0.1";
    /// TCP port to which the cabinet connects; 0: a free one.
    std::uint16_t port = 12225;
    /// Number format that the cabinet is set to.
    Precision precision = Precision::float32;
    /// Period in which the cabinet is asked for its state, > 0.
    std::chrono::nanoseconds cycle{std::chrono::milliseconds(10)};
    /// Longest silence of the cabinet after a command.
    std::chrono::nanoseconds answer_timeout{std::chrono::milliseconds(100)};
    /// Index of the attached tool in the station's setup; -1: none.
    int tool = -1;
    /// Largest inaccuracy of the cabinet's force estimate [N]; a force condition also ends a motion
    /// if the estimate is less accurate.
    double force_tolerance = 10.0;
};

/// An LBR iiwa whose cabinet runs the robot application of libiiwa; the cabinet connects to this
/// program.
///
/// As a device::Arm it streams set-points through the servo interface; as a device::MotionPlanner
/// it lets the cabinet plan. The protocol has no safety state: `protective_stop` means that the
/// cabinet is not ready to move. If it is not ready, the running motion is cancelled, so that the
/// arm does not go on when somebody makes the cabinet ready again. If the connection ends for any
/// reason, the robot application stops the arm and ends; an operator has to start it again.
/// Source: docs/protocols/iiwa.md.
///
/// Its destructor closes the connection; the cabinet then stops a moving arm.
class IiwaArm : public device::Arm, public device::MotionPlanner {
public:
    /// Opens the port and waits for the cabinet on a thread of its own; until it connects, the arm
    /// is disconnected.
    /// \param model model of an arm with 7 axes; must outlive the arm
    /// Errors: invalid_argument (model, cycle, not an address of this computer), already_exists
    ///         (the port is taken).
    static Result<std::unique_ptr<IiwaArm>> create(const IiwaOptions& options,
                                                   const motion::RobotModel& model);

    /// TCP port at which the cabinet is awaited.
    virtual std::uint16_t port() const = 0;
    /// Sensor of the wrench at the flange that the cabinet estimates; lives as long as the arm.
    virtual device::ForceTorqueSensor& flangeForce() noexcept = 0;
};

}  // namespace metier::iiwa_driver
