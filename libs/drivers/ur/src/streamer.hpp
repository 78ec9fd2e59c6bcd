#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>

#include "controller_state.hpp"
#include "metier/device/arm_core.hpp"
#include "rtde.hpp"
#include "set_point_pace.hpp"
#include "ur_settings.hpp"

namespace metier::ur_driver {

/// Why the driver itself ended a motion. Trivially copyable.
struct StreamFault {
    enum class Kind : std::uint8_t {
        none,
        not_finite,     ///< a set-point is no number: axis
        slowed,         ///< the controller stretches the time: value is its speed scaling
        program_ended,  ///< someone stopped or paused the script: runtime_state
        not_taken,      ///< the script does not take set-points: value is for how long [s]
        not_followed,   ///< target_q is elsewhere: axis, value, and low to high of the set-points
        not_started,    ///< the script has not answered: runtime_state; value is the time [s]
    };
    Kind kind = Kind::none;
    std::size_t axis = 0;
    double value = 0.0;
    double low = 0.0;
    double high = 0.0;
    RuntimeState runtime_state = RuntimeState::stopped;
};

/// Text for a person, without the device's name.
std::string toText(const StreamFault& fault);

/// Streams set-points in the cycle of the controller: asks the source, writes set-points, watches
/// that the controller obeys. Has no socket, no thread and no clock.
///
/// The script is uploaded when a source is attached and none runs. It goes on holding the last
/// set-point after a source was done, so that the next one begins at once.
///
/// Threading: the cycle thread; neither locks, allocates, logs nor throws. refuseStart() and
/// token() from any thread.
class Streamer {
public:
    /// Actions for the caller of cycle().
    struct Output {
        bool write = false;  ///< send `setpoint`
        rtde::Setpoint setpoint{};
        std::int32_t upload = 0;    ///< not 0: upload the script with this token
        bool stop_program = false;  ///< the script does not obey: stop it at the dashboard
        StreamFault fault{};        ///< fault to report and to keep until a reset
    };

    /// \param settings     with a frequency > 0
    /// \param max_velocity the controller's limits [rad/s]; 0: not known
    /// \param first_token  of the scripts; not 0, best another one in every process
    Streamer(device::ArmCore& core, const UrSettings& settings, const Joints& max_velocity,
             std::int32_t first_token);

    /// One data package came. The safety state of the core must be the package's already.
    Output cycle(const ControllerState& now, SteadyTime stamp) noexcept;
    /// Notes that the link is gone; the safety state of the core must be disconnected already.
    void disconnected() noexcept;
    /// Notes that the script with this token could not be uploaded; the reason was reported
    /// already.
    void refuseStart(std::int32_t token) noexcept { refused_token_.store(token); }
    /// Token of the newest script; a running program with another token is not ours.
    std::int32_t token() const noexcept { return token_.load(); }
    /// Reports whether the script runs or is about to.
    bool busy() const noexcept { return busy_.load(); }
    /// Reports whether one of the last set-points was faster than an axis may be.
    bool limitBroken() const noexcept { return cycles_since_violation_ < kViolationMemory; }

private:
    enum class Phase : std::uint8_t { idle, priming, starting, running, ending };

    static constexpr std::size_t kHistory = 512;
    static constexpr int kViolationMemory = 250;

    void measure(const ControllerState& now, SteadyTime stamp) noexcept;
    void begin() noexcept;
    void advance(const ControllerState& now, Output& out) noexcept;
    void prime(const ControllerState& now, Output& out) noexcept;
    void awaitScript(const ControllerState& now, Output& out) noexcept;
    void follow(const ControllerState& now, Output& out) noexcept;
    void ask(Output& out) noexcept;
    void finish(const ControllerState& now, Output& out) noexcept;
    StreamFault findFault(const ControllerState& now) noexcept;
    StreamFault findDeviation(const ControllerState& now) noexcept;
    void fail(const StreamFault& fault, Output& out) noexcept;
    void brake() noexcept;
    void enter(Phase phase) noexcept;
    void take(const device::JointArray& set_point) noexcept;
    void remember(const Joints& position) noexcept;
    bool standing() const noexcept;
    double seconds(std::uint32_t cycles) const noexcept;

    device::ArmCore& core_;
    const UrSettings settings_;
    const Joints max_velocity_;
    const double cycle_;        // [s]
    const std::size_t window_;  // cycles in which target_q may lag behind
    const std::uint32_t patience_;
    const std::uint32_t start_timeout_;
    SetPointPace pace_;

    Phase phase_ = Phase::idle;
    device::ArmState state_;
    rtde::Setpoint setpoint_;
    std::int32_t first_counter_ = 0;  // first counter of this script
    std::uint32_t phase_cycles_ = 0;
    std::uint32_t stand_cycles_ = 0;
    std::uint32_t slow_cycles_ = 0;
    std::uint32_t astray_cycles_ = 0;
    int cycles_since_violation_ = kViolationMemory;
    double last_timestamp_ = -1.0;
    bool done_ = false;
    bool stop_asked_ = false;  // a stop was requested at the dashboard since the braking began
    std::array<Joints, kHistory> history_{};
    std::size_t history_size_ = 0;
    std::size_t history_next_ = 0;

    std::atomic<std::int32_t> token_;
    std::atomic<std::int32_t> refused_token_{0};
    std::atomic<bool> busy_{false};
};

}  // namespace metier::ur_driver
