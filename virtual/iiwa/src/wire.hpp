#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "metier/motion/pose.hpp"

/// The numbers that a PC and the robot application on the cabinet exchange (libiiwa).
namespace metier::virtual_iiwa {

/// Format of a number, big-endian; the cabinet's process data choose it.
enum class Precision : std::uint8_t { single_precision, double_precision };

struct Command {
    double code = 0.0;
    std::array<double, 7> arguments{};
};

/// 32 or 64 [bytes].
std::size_t commandSize(Precision precision) noexcept;
/// \param bytes commandSize() of them
Command decodeCommand(std::span<const std::byte> bytes, Precision precision) noexcept;

/// Places in the state.
namespace state_index {
inline constexpr std::size_t kStatus = 0;
inline constexpr std::size_t kJointPosition = 1;
inline constexpr std::size_t kJointVelocity = 8;
inline constexpr std::size_t kJointTorque = 15;
inline constexpr std::size_t kPosition = 22;
inline constexpr std::size_t kOrientation = 25;
inline constexpr std::size_t kForce = 28;
inline constexpr std::size_t kTorque = 31;
inline constexpr std::size_t kError = 34;
inline constexpr std::size_t kConditionFired = 35;
inline constexpr std::size_t kReady = 36;
inline constexpr std::size_t kMoving = 37;
inline constexpr std::size_t kCount = 38;
}  // namespace state_index

using StateNumbers = std::array<double, state_index::kCount>;
std::vector<std::byte> encodeState(const StateNumbers& state, Precision precision);

/// A pose from X, Y, Z [mm] and A, B, C [rad], which turn about z, y and x, and back.
motion::Pose toPose(const std::array<double, 6>& xyzabc);
std::array<double, 6> toNumbers(const motion::Pose& pose);

/// Value of element 34 of the state; it stays until another error comes.
enum class ErrorCode : std::int8_t {
    none = -10,
    value = -11,
    synchronous_motion = -13,
    asynchronous_motion = -14,
    impedance = -15,
    configuration = -16,
};

}  // namespace metier::virtual_iiwa
