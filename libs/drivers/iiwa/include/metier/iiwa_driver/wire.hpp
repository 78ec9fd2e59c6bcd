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
enum class Precision : std::uint8_t { float32, float64 };

/// Commands of the robot application. Source: docs/protocols/iiwa.md#commands.
enum class Code : std::uint16_t {
    state = 0,
    cancel = 101,
    move_joints = 102,
    move_pose = 103,
    joint_velocity = 201,
    joint_acceleration = 202,
    line_velocity = 204,
    line_acceleration = 205,
    force_condition = 211,
    interface = 302,
    motion_type = 303,
    control_mode = 304,
    execution = 305,
    tool = 400,
};

/// One command in the units of the wire: mm, rad, N.
struct Command {
    Code code = Code::state;
    std::array<double, 7> arguments{};
};

/// The bytes of a whole command.
class CommandBytes {
public:
    static constexpr std::size_t kLongest = 64;

    std::span<const std::byte> bytes() const noexcept { return {bytes_.data(), size_}; }

private:
    friend CommandBytes encode(const Command& command, Precision precision) noexcept;

    std::array<std::byte, kLongest> bytes_{};
    std::size_t size_ = 0;
};

/// Encodes a command as eight big-endian numbers. Neither allocates nor throws.
CommandBytes encode(const Command& command, Precision precision) noexcept;

/// Number of bytes of a state, which has 38 numbers.
constexpr std::size_t stateSize(Precision precision) noexcept {
    return precision == Precision::float32 ? 38 * 4 : 38 * 8;
}
inline constexpr std::size_t kLongestState = stateSize(Precision::float64);

/// The cabinet's answer to every command, in SI units. Trivially copyable.
struct CabinetState {
    bool executed = false;             ///< the command was executed or scheduled; false for `state`
    device::JointArray position;       ///< [rad]
    device::JointArray velocity;       ///< differences over some 10 ms [rad/s]
    device::JointArray joint_torque;   ///< external torque [Nm]; not finite: not known
    Frame pose;                        ///< pose of the tool, or of the flange without a tool, in
                                       ///< the base frame
    std::array<double, 3> force{};     ///< at the flange, in its axes [N]; not finite: not known
    std::array<double, 3> torque{};    ///< [Nm]; not finite: not known
    int last_error = 0;                ///< never reset: see errorText()
    bool force_condition_met = false;  ///< the force condition ended the last motion
    bool ready = false;                ///< the cabinet is ready to move
    bool active = false;               ///< a motion is under way
};

/// Reason why a state cannot be used.
struct StateError {
    enum class Kind : std::uint8_t {
        size,          ///< `value` bytes
        not_a_flag,    ///< `element` is `value`, neither 0 nor 1
        not_finite,    ///< `element`
        out_of_range,  ///< `element` is `value`
    };
    Kind kind = Kind::size;
    std::size_t element = 0;  ///< index from 0, as in docs/protocols/iiwa.md#state
    double value = 0.0;
};
/// Error text for a person. The code is connection_lost, since the two sides no longer understand
/// each other.
Error toError(const StateError& error);

/// Decodes and checks a state. Neither allocates nor throws. Positions, velocities and the pose
/// must be finite and possible for an arm of this kind; forces need not be finite.
tl::expected<CabinetState, StateError> parseState(std::span<const std::byte> bytes,
                                                  Precision precision) noexcept;

/// Meaning of an error code of the cabinet; "" if there is no error.
std::string_view errorText(int code) noexcept;

}  // namespace metier::iiwa_driver
