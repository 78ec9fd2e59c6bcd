#pragma once

#include <chrono>
#include <cstdint>
#include <span>
#include <string>

#include "frame.hpp"
#include "metier/base/error.hpp"

namespace metier::wsg50_driver {

// Meaning of frames. Units on the wire are mm, mm/s, mm/s2 and N; here m, m/s, m/s2 and N.

/// Status codes that the driver acts on; describe() knows them all.
enum class Status : std::uint16_t {
    success = 0,
    command_failed = 18,
    aborted = 19,
    pending = 26,
    blocked = 29,
};

/// "axis blocked (status 29)".
std::string describe(Status status);

/// A reply, or an update that came by itself.
struct Reply {
    CommandId id{};
    Status status = Status::success;
    std::span<const std::byte> data{};  ///< only on success
};

/// Errors: invalid_argument if there is no room for a status.
Result<Reply> parseReply(const Frame& frame);

/// Bits of the system state.
class SystemState {
public:
    SystemState() = default;
    explicit SystemState(std::uint32_t bits) noexcept : bits_(bits) {}

    bool referenced() const noexcept { return has(0); }
    bool moving() const noexcept { return has(1); }
    /// Fast stop, or a fault of temperature, power, current or a finger: acknowledge it.
    bool fault() const noexcept { return (bits_ & kFaults) != 0; }
    /// The faults by name, "fast stop, power fault"; empty without one.
    std::string faultText() const;

private:
    static constexpr std::uint32_t kFaults = 1U << 12 | 1U << 14 | 1U << 15 | 1U << 16 | 1U << 17;

    bool has(unsigned bit) const noexcept { return (bits_ >> bit & 1U) != 0; }

    std::uint32_t bits_ = 0;
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

/// The state's name, for texts.
std::string_view toString(GraspingState state) noexcept;

/// Limits of the gripper.
struct Limits {
    double stroke = 0.110;     ///< [m]
    double min_speed = 0.005;  ///< [m/s]
    double max_speed = 0.420;
    double min_acceleration = 0.1;  ///< [m/s2]
    double max_acceleration = 5.0;
    double min_force = 5.0;   ///< [N]
    double max_force = 80.0;  ///< without overdrive

    bool operator==(const Limits&) const = default;
};

// Data of successful replies. Errors: invalid_argument for a wrong length, a value that is not
// finite or not possible.
Result<SystemState> parseSystemState(std::span<const std::byte> data);
Result<GraspingState> parseGraspingState(std::span<const std::byte> data);
/// [m]
Result<double> parseWidth(std::span<const std::byte> data);
/// [N]
Result<double> parseForce(std::span<const std::byte> data);
Result<Limits> parseLimits(std::span<const std::byte> data);

Command homeCommand() noexcept;
/// Moves the jaws to an absolute width; they stop at an obstacle instead of clamping it.
Command positionCommand(double width, double speed) noexcept;
/// \param width nominal width of the part
Command graspCommand(double width, double speed) noexcept;
Command releaseCommand(double width, double speed) noexcept;
Command acknowledgeCommand() noexcept;
Command accelerationCommand(double acceleration) noexcept;
Command forceLimitCommand(double force) noexcept;
/// Asks for a value now and then once per period, whether or not it changed.
Command updateCommand(CommandId value, std::chrono::milliseconds period) noexcept;

}  // namespace metier::wsg50_driver
