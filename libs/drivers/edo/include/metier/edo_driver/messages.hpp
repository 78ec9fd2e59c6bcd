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
    std::size_t axes = 6;  ///< without the gripper, 1 to 6
    bool gripper = false;

    std::size_t count() const noexcept { return axes + (gripper ? 1 : 0); }
    /// Joint mask of the messages: one bit per joint.
    std::uint64_t mask() const noexcept { return (std::uint64_t{1} << count()) - 1; }
    bool isGripper(std::size_t joint) const noexcept { return gripper && joint == axes; }
};

/// One joint of /usb_jnt_state: [rad], [rad/s], for the gripper [m], [m/s]. NaN if the robot sent
/// null.
struct JointSample {
    double position = 0.0;
    double velocity = 0.0;
    double current = 0.0;     ///< [A]
    std::uint32_t flags = 0;  ///< commandFlag
};

/// All joints, once per cycle of the robot (100 Hz).
struct JointStates {
    std::size_t count = 0;
    std::array<JointSample, kMaxJoints> joints{};
};

/// /machine_state, at 10 Hz.
struct MachineState {
    enum State : std::uint8_t {
        init = 0,
        not_calibrated = 1,
        calibrated = 2,
        move = 3,
        jog = 4,
        error = 5,
        braked = 6,
        brakes_check = 7,
        move_test = 8,
        command = 255,  ///< a command is being executed
    };
    /// Bits of the opcode.
    enum Opcode : std::uint32_t {
        no_ack = 1U << 0U,
        joint_absent = 1U << 1U,
        overcurrent = 1U << 2U,
        uncalibrated = 1U << 3U,
        position_error = 1U << 4U,
        bus_error = 1U << 5U,
        brake_active = 1U << 6U,
        emergency_stop = 1U << 7U,
        fence = 1U << 8U,
        collision = 1U << 9U,
    };

    std::uint8_t state = init;
    std::uint32_t opcode = 0;

    bool operator==(const MachineState&) const = default;
};

/// /algorithm_state: state of the robot's own trajectory generator.
struct AlgorithmState {
    int value = 0;
};

/// /machine_movement_ack.
struct MovementFeedback {
    /// Values of `type`.
    enum Type : std::int8_t {
        received = 0,
        need_data = 1,
        executed = 2,
        error = -1,
        rejected = -2,
        buffer_full = -3,
    };
    int type = 0;
    int data = 0;
};

/// The answer to a call of a service.
struct ServiceResponse {
    std::string id;
    bool ok = false;                        ///< the service ran
    std::optional<int> result_code{};       ///< answer of ControlSwitch: 0 done, 1 refused
    std::optional<std::string> software{};  ///< answer of SoftwareVersion: version of the entry
                                            ///< with id 255
    std::string text{};                     ///< reason why it did not run
};

/// A status message (error or warning) of the rosbridge server.
struct Status {
    std::string level;
    std::string text;
};

/// A message that the driver does not use.
struct Ignored {};

using Incoming = std::variant<Ignored, JointStates, MachineState, AlgorithmState, MovementFeedback,
                              ServiceResponse, Status>;

/// A set-point of all joints: [rad], for the gripper [m].
struct JointSetPoint {
    std::size_t count = 0;
    std::array<double, kMaxJoints> position{};
};

/// A joint motion that the robot plans by itself.
struct JointMove {
    JointSetPoint target;
    int override_percent = 100;  ///< share of the full speed [%], 1 to 100
};

/// Parameters of releasing the brakes (JointReset).
struct ResetRequest {
    std::uint32_t steps = 2000;
    double offset = 0.0;  ///< way of the joints meanwhile [rad]
};

}  // namespace metier::edo_driver
