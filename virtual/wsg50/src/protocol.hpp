#pragma once

#include <cstdint>

/// Numbers of the binary commands of a Weiss WSG 50.
namespace metier::virtual_wsg50 {

enum class Command : std::uint8_t {
    loop = 0x06,
    disconnect = 0x07,
    home = 0x20,
    pre_position = 0x21,
    stop = 0x22,
    fast_stop = 0x23,
    acknowledge = 0x24,
    grasp = 0x25,
    release = 0x26,
    set_acceleration = 0x30,
    get_acceleration = 0x31,
    set_force_limit = 0x32,
    get_force_limit = 0x33,
    set_soft_limits = 0x34,
    get_soft_limits = 0x35,
    clear_soft_limits = 0x36,
    overdrive = 0x37,
    tare = 0x38,
    system_state = 0x40,
    grasping_state = 0x41,
    statistics = 0x42,
    width = 0x43,
    speed = 0x44,
    force = 0x45,
    temperature = 0x46,
    system_info = 0x50,
    set_device_tag = 0x51,
    get_device_tag = 0x52,
    limits = 0x53,
    finger_info = 0x60,
    finger_flags = 0x61,
    finger_power = 0x62,
    finger_data = 0x63,
};

enum class Status : std::uint16_t {
    success = 0,
    not_available = 1,
    not_initialised = 3,
    checksum_error = 11,
    no_parameters_expected = 12,
    not_enough_parameters = 13,
    unknown_command = 14,
    access_denied = 16,
    command_failed = 18,
    command_aborted = 19,
    invalid_parameter = 24,
    pending = 26,
    range_error = 28,
    axis_blocked = 29,
};

enum class GraspingState : std::uint8_t {
    idle = 0,
    grasping = 1,
    no_part = 2,
    part_lost = 3,
    holding = 4,
    releasing = 5,
    positioning = 6,
    error = 7,
};

/// Bits of the system state.
namespace system_bit {
inline constexpr std::uint32_t kReferenced = 1U << 0U;
inline constexpr std::uint32_t kMoving = 1U << 1U;
inline constexpr std::uint32_t kBlockedMinus = 1U << 2U;
inline constexpr std::uint32_t kBlockedPlus = 1U << 3U;
inline constexpr std::uint32_t kSoftLimitMinus = 1U << 4U;
inline constexpr std::uint32_t kSoftLimitPlus = 1U << 5U;
inline constexpr std::uint32_t kAxisStopped = 1U << 6U;
inline constexpr std::uint32_t kTargetReached = 1U << 7U;
inline constexpr std::uint32_t kOverdrive = 1U << 8U;
inline constexpr std::uint32_t kFastStop = 1U << 12U;
inline constexpr std::uint32_t kTemperatureFault = 1U << 14U;
}  // namespace system_bit

}  // namespace metier::virtual_wsg50
