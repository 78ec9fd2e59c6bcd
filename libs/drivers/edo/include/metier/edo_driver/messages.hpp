#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>

#include "metier/device/joint_array.hpp"

namespace metier::edo_driver {

// Messages from and to the robot, in SI units and radians. Source: docs/protocols/edo.md.

/// Largest number of joints of an e.DO: six axes and the gripper.
inline constexpr std::size_t kMaxJoints = 7;

/// The joints of one robot. Joint i is an axis for i < axes; the gripper follows the last axis.
struct JointLayout {
    /// Number of axes without the gripper, 1 to 6.
    std::size_t axes = 6;
    /// Whether a gripper is the joint after them.
    bool gripper = false;

    /// Number of joints, 1 to kMaxJoints.
    std::size_t count() const noexcept { return axes + (gripper ? 1 : 0); }
    /// Joint mask of the messages: one bit per joint.
    /// Bit 0 is axis 1.
    std::uint64_t mask() const noexcept { return (std::uint64_t{1} << count()) - 1; }
    /// Whether that joint, counted from 0, is the gripper.
    bool isGripper(std::size_t joint) const noexcept { return gripper && joint == axes; }
};

/// One joint of /usb_jnt_state: [rad], [rad/s], for the gripper [m], [m/s]. NaN if the robot sent
/// null.
struct JointSample {
    /// Measured position [rad], gripper [m].
    double position = 0.0;
    /// Measured velocity [rad/s], gripper [m/s].
    double velocity = 0.0;
    /// Current of its motor [A].
    double current = 0.0;
    /// Field commandFlag, as the robot sent it.
    std::uint32_t flags = 0;
};

/// All joints, once per cycle of the robot (100 Hz).
/// Compare `count` with JointLayout::count() before use.
struct JointStates {
    /// Number of joints that the robot sent.
    std::size_t count = 0;
    /// Joints, axis 1 first; those beyond `count` have no meaning.
    std::array<JointSample, kMaxJoints> joints{};
};

/// Message /machine_state, at 10 Hz. Source: docs/protocols/edo.md#machine-state.
struct MachineState {
    /// Values of `state`; others are passed on as they are.
    enum State : std::uint8_t {
        init = 0,            ///< the joints are not discovered yet
        not_calibrated = 1,  ///< a person has to move each axis to its notch
        calibrated = 2,      ///< ready to move
        move = 3,            ///< moves by the robot's own plan
        jog = 4,             ///< is jogged
        error = 5,           ///< the robot must be restarted
        braked = 6,          ///< brakes are closed; JointReset releases them
        brakes_check = 7,    ///< checks its brakes
        move_test = 8,       ///< tests its motion
        command = 255,       ///< a command is being executed
    };
    /// Bits of the opcode: faults that the robot reports, several at once.
    enum Opcode : std::uint32_t {
        no_ack = 1U << 0U,          ///< a joint does not answer
        joint_absent = 1U << 1U,    ///< a joint is not there
        overcurrent = 1U << 2U,     ///< too much current in a motor
        uncalibrated = 1U << 3U,    ///< a joint is not calibrated
        position_error = 1U << 4U,  ///< a joint does not follow
        bus_error = 1U << 5U,       ///< the bus to the joints fails
        brake_active = 1U << 6U,    ///< the brakes are closed
        emergency_stop = 1U << 7U,  ///< the button is pressed
        fence = 1U << 8U,           ///< the contact of the fence
        collision = 1U << 9U,       ///< a joint has noticed a collision
    };

    /// A State, as its number.
    std::uint8_t state = init;
    /// Bits of Opcode; 0: no fault.
    std::uint32_t opcode = 0;

    bool operator==(const MachineState&) const = default;
};

/// Message /algorithm_state: state of the robot's own trajectory generator.
struct AlgorithmState {
    /// Number; Generation::taken_state while control is taken.
    int value = 0;
};

/// Message /machine_movement_ack: progress of a move that the robot plans.
struct MovementFeedback {
    /// Values of `type`.
    enum Type : std::int8_t {
        received = 0,      ///< the move has arrived
        need_data = 1,     ///< the robot asks for the next move
        executed = 2,      ///< the move is over
        error = -1,        ///< the move has failed
        rejected = -2,     ///< the move was not taken
        buffer_full = -3,  ///< the robot has no room for the move
    };
    /// A Type, as its number.
    int type = 0;
    /// Further number, whose meaning depends on the type.
    int data = 0;
};

/// The answer to a call of a service.
struct ServiceResponse {
    /// Id of the call.
    std::string id;
    /// Whether the service ran.
    bool ok = false;
    /// Answer of ControlSwitch: 0 done, 1 refused.
    std::optional<int> result_code{};
    /// Answer of SoftwareVersion: version of the entry with id 255.
    std::optional<std::string> software{};
    /// Reason why it did not run.
    std::string text{};
};

/// A status message (error or warning) of the rosbridge server.
struct Status {
    /// Level: "error", "warning", "info".
    std::string level;
    /// Text of the server.
    std::string text;
};

/// A message that the driver does not use.
struct Ignored {};

/// Any message from the robot.
using Incoming = std::variant<Ignored, JointStates, MachineState, AlgorithmState, MovementFeedback,
                              ServiceResponse, Status>;

/// A set-point of all joints: [rad], for the gripper [m].
struct JointSetPoint {
    /// Number of joints, JointLayout::count().
    std::size_t count = 0;
    /// Positions, axis 1 first [rad], gripper [m].
    std::array<double, kMaxJoints> position{};
};

/// A joint motion that the robot plans by itself.
struct JointMove {
    /// Joint position at its end.
    JointSetPoint target;
    /// Share of the full speed [%], 1 to 100.
    int override_percent = 100;
};

/// Parameters of releasing the brakes (JointReset).
struct ResetRequest {
    /// Number of steps in which the brakes are released.
    std::uint32_t steps = 2000;
    /// Way of the joints meanwhile [rad]; 0: they do not move.
    double offset = 0.0;
};

}  // namespace metier::edo_driver
