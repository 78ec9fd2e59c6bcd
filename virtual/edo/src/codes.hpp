#pragma once

#include <cstdint>

namespace metier::virtual_edo {

// Source of all: Comau/eDO_core, include/EdoMsgType.h, State.h, EdoState.h.

enum class MachineState : std::uint8_t {
    init = 0,
    not_calibrated = 1,
    calibrated = 2,
    move = 3,
    jog = 4,
    error = 5,
    braked = 6,
    brakes_check = 7,
    command = 255,  ///< waits for the joints to acknowledge a command
};

/// Bits of the machine's opcode.
enum class Opcode : std::uint8_t {
    no_acknowledgement = 0,
    joint_absent = 1,
    overcurrent = 2,
    uncalibrated = 3,
    brake_active = 6,
    emergency_stop = 7,
};

/// Commands that the low four bits of a joint's commandFlag acknowledge.
enum class Acknowledge : std::uint8_t {
    nothing = 0,
    init = 1,
    calibration = 2,
    configuration = 3,
    reset = 4,
};

/// Bits of a joint's commandFlag above the acknowledgement.
enum class JointFlag : std::uint8_t {
    power_stage_open = 5,
    overcurrent = 6,
    uncalibrated = 7,
    collision = 8,
    following_error = 11,
    stroke_end = 14,
};

/// Modes of /bridge_init.
enum class InitMode : std::uint8_t { discovery = 0, mask_joints = 4 };

namespace move_command {
inline constexpr std::uint8_t kMove = 'M';
inline constexpr std::uint8_t kCancel = 'C';
inline constexpr std::uint8_t kPause = 'P';
inline constexpr std::uint8_t kResume = 'R';
inline constexpr std::uint8_t kJog = 'J';
inline constexpr std::uint8_t kJogStop = 'S';
}  // namespace move_command

namespace move_type {
inline constexpr std::uint8_t kJoint = 'J';
inline constexpr std::uint8_t kLinear = 'L';
inline constexpr std::uint8_t kCircular = 'C';
}  // namespace move_type

namespace point_type {
inline constexpr std::uint8_t kJoint = 'J';
inline constexpr std::uint8_t kCartesian = 'P';
inline constexpr std::uint8_t kExtended = 'X';  ///< Cartesian and auxiliary axes
}  // namespace point_type

/// The delay of a move that blends into the next.
inline constexpr std::uint8_t kFly = 255;

enum class FeedbackType : std::int8_t {
    buffer_full = -3,
    rejected = -2,
    error = -1,
    received = 0,
    need_data = 1,
    executed = 2,
};

/// Data of a MovementFeedback, besides its type.
enum class FeedbackData : std::int8_t {
    undefined_command = -101,
    uninitialised = -102,
    move_failed = -103,
    /// Error of the trajectory library: incomplete or inconsistent motion.
    no_motion = -76,
    none = 0,
    move_ended = 1,
    linear_jog_started = 2,
    fly_ended = 10,
    last_fly_ended = 11,
    next_wanted = 12,
    delay_over = 13,
    dropped_by_cancel = 20,
    dropped_by_control = 30,
    paused = 40,
    resumed = 50,
    cancelled = 60,
    resume_in_alarm = 75,
    dropped_buffer_full = 100,
};

struct Feedback {
    FeedbackType type = FeedbackType::received;
    FeedbackData data = FeedbackData::none;

    bool operator==(const Feedback&) const = default;
};

/// /algorithm_state.
enum class AlgorithmMode : std::int8_t {
    uninitialised = 0,
    initialised = 1,
    moving = 2,
    waiting = 3,
    blocked = 4,
    finished = 5,
    pause = 6,
    switched_off = 9,
    position_control = 10,
    velocity_control = 11,
    voltage_control = 12,
};

}  // namespace metier::virtual_edo
