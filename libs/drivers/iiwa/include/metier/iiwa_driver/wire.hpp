#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "metier/base/error.hpp"
#include "metier/base/quantities.hpp"
#include "metier/device/joint_array.hpp"

namespace metier::iiwa_driver {

/// Number of axes of the arm.
inline constexpr std::size_t kAxes = 7;

/// Number format of the cabinet; a switch in its process data, not negotiated on the wire.
enum class Precision : std::uint8_t {
    float32,  ///< 4 bytes per number
    float64   ///< 8 bytes per number
};

/// Commands of the robot application. Source: docs/protocols/iiwa.md#commands.
enum class Code : std::uint16_t {
    /// Answers with the state only.
    state = 0,
    /// Cancels the motion.
    cancel = 101,
    /// Moves to 7 joint positions [rad]; with the servo interface, changes the target.
    move_joints = 102,
    /// Moves to X Y Z [mm], A B C [rad], by the motion type.
    move_pose = 103,
    /// Share of the largest joint velocity, 0 to 1.
    joint_velocity = 201,
    /// Share of the largest joint acceleration, 0 to 1.
    joint_acceleration = 202,
    /// Velocity along a line [mm/s].
    line_velocity = 204,
    /// Acceleration along a line [mm/s²].
    line_acceleration = 205,
    /// Three force limits along the axes of the flange and their tolerances [N]; NaN: not watched.
    force_condition = 211,
    /// Control interface: 31 standard, 32 servo.
    interface = 302,
    /// Motion type of move_pose: 21 PTP, 22 LIN.
    motion_type = 303,
    /// Control mode: 41 position.
    control_mode = 304,
    /// Execution: 51 asynchronous, so that the state comes at once.
    execution = 305,
    /// Attaches the tool of that index; poses are then those of the tool.
    tool = 400,
};

/// One command in the units of the wire: mm, rad, N.
struct Command {
    /// Number of the command.
    Code code = Code::state;
    /// Arguments of the command; those that it does not have are 0.
    std::array<double, 7> arguments{};
};

/// The bytes of a whole command.
class CommandBytes {
public:
    /// Length of the longest command [byte]: eight numbers of 8 byte.
    static constexpr std::size_t kLongest = 64;

    /// Bytes as they are sent; valid as long as this.
    std::span<const std::byte> bytes() const noexcept { return {bytes_.data(), size_}; }

private:
    friend CommandBytes encode(const Command& command, Precision precision) noexcept;

    std::array<std::byte, kLongest> bytes_{};
    std::size_t size_ = 0;
};

/// Encodes a command as eight big-endian numbers: its code and seven arguments. Neither allocates
/// nor throws. Threads: any; pure.
CommandBytes encode(const Command& command, Precision precision) noexcept;

/// Number of bytes of a state, which has 38 numbers.
constexpr std::size_t stateSize(Precision precision) noexcept {
    return precision == Precision::float32 ? 38 * 4 : 38 * 8;
}
/// Length of the longest state [byte], for a buffer.
inline constexpr std::size_t kLongestState = stateSize(Precision::float64);

/// The cabinet's answer to every command, in SI units. Trivially copyable.
struct CabinetState {
    /// Whether the command was executed or scheduled; false for `state`.
    bool executed = false;
    /// Joint position [rad].
    device::JointArray position;
    /// Joint velocity by differences over some 10 ms [rad/s].
    device::JointArray velocity;
    /// External torque of each joint [N m]; not finite: not known.
    device::JointArray joint_torque;
    /// Pose of the tool, or of the flange without a tool, in the base frame [m, rad].
    Frame pose;
    /// External force at the flange, in its axes [N]; not finite: not known.
    std::array<double, 3> force{};
    /// External torque at the flange, in its axes [N m]; not finite: not known.
    std::array<double, 3> torque{};
    /// Last error of the cabinet, which is never reset: see errorText().
    int last_error = 0;
    /// Whether the force condition ended the last motion.
    bool force_condition_met = false;
    /// Whether the cabinet is ready to move.
    bool ready = false;
    /// Whether a motion is under way.
    bool active = false;
};

/// Reason why a state cannot be used.
struct StateError {
    /// Check that the state did not pass; decides what `element` and `value` are.
    enum class Kind : std::uint8_t {
        /// The state has `value` bytes instead of stateSize().
        size,
        /// `element` is `value`, neither 0 nor 1.
        not_a_flag,
        /// `element` is not finite.
        not_finite,
        /// `element` is `value`, which no arm of this kind can have: over 6.3 rad, 50 rad/s or 10
        /// m.
        out_of_range,
    };
    /// Kind of the error.
    Kind kind = Kind::size;
    /// Index from 0, as in docs/protocols/iiwa.md#state.
    std::size_t element = 0;
    /// Number that was received.
    double value = 0.0;
};
/// Error text for a person. The code is connection_lost, since the two sides no longer understand
/// each other.
Error toError(const StateError& error);

/// Decodes and checks a state. Neither allocates nor throws. Positions, velocities and the pose
/// must be finite and possible for an arm of this kind; forces need not be finite.
tl::expected<CabinetState, StateError> parseState(std::span<const std::byte> bytes,
                                                  Precision precision) noexcept;

/// Meaning of an error code of the cabinet; "" if there is no error. Valid for ever. Threads: any;
/// pure.
std::string_view errorText(int code) noexcept;

}  // namespace metier::iiwa_driver
