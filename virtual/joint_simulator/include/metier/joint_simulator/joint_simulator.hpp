#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "metier/base/latest_value.hpp"
#include "metier/device/arm.hpp"
#include "metier/device/safety_publisher.hpp"
#include "metier/device/shared_value.hpp"
#include "metier/joint_simulator/guard.hpp"
#include "metier/joint_simulator/lag.hpp"

namespace metier::joint_simulator {

/// Properties of a simulated arm.
/// optionsFor() fills them from a robot's model.
struct JointSimulatorOptions {
    /// Name of the arm in messages.
    std::string name;
    /// One name per axis, 1 to device::kMaxAxes.
    std::vector<std::string> axis_names;
    /// Limits of the simulated controller, one per axis.
    std::vector<AxisLimits> limits;
    /// Position at the start [rad], within the limits.
    std::vector<double> start_position;
    /// Period of the controller, > 0.
    std::chrono::nanoseconds cycle{};
    /// Amounts by which a set-point may exceed a limit.
    GuardTolerance tolerance;
    /// Dead time from set-point to measured arm [cycles], <= kMaxDelayCycles.
    std::size_t delay_cycles = 2;
    /// Time constant of the lag after that [s]; 0: no lag.
    double time_constant = 0.0;
    /// Speed below which the measured arm counts as standing [rad/s].
    double standstill_speed = 1e-3;
};

/// State of the emergency stop's button.
/// The safety state stays emergency_stop after the release, until resetFault().
enum class EmergencyStop : std::uint8_t { released, pressed };

/// A simulated robot arm: follows set-points with a lag, checks each with its own guard and stops
/// by itself when one breaks a limit.
///
///     auto arm = JointSimulator::create(optionsFor(model));
///     (*arm)->attach(source);
///     for (int cycle = 0; cycle < 100; ++cycle) { (*arm)->step(); }
///
/// It has no thread: cycle() is one period of the controller and the only thing that makes time
/// pass. Tests move time by hand with step(); SimulatorDrive runs the arm at its real rate.
///
/// After a violation each axis brakes at its acceleration limit, off the path as a real robot
/// would, and the safety state is protective_stop until resetFault(). A set-point that breaks a
/// limit is never taken.
///
/// Threading: as device::Arm; cycle() and dispatch() each from one thread.
class JointSimulator final : public device::Arm {
public:
    /// The arm stands at the start position, its safety state is normal, and time stands still.
    /// Number of axes: 1 to device::kMaxAxes. The message names axis, value, limit and unit.
    /// Errors: invalid_argument if sizes differ, a limit or the cycle is not positive, or the start
    ///         position is outside the limits.
    static Result<std::unique_ptr<JointSimulator>> create(JointSimulatorOptions options);

    /// Ends a source that is still attached with EndCause::disconnected.
    ~JointSimulator() override;
    JointSimulator(const JointSimulator&) = delete;
    JointSimulator& operator=(const JointSimulator&) = delete;

    /// Never changes; valid as long as the arm.
    const device::ArmInfo& info() const noexcept override { return info_; }
    /// As of the last cycle(). While disconnected, position, velocity and stamp stay those of the
    /// last cycle before, as a real controller's would; `cycle` counts on.
    device::ArmState state() const noexcept override { return published_.read(); }
    /// As of the last cycle() or resetFault(), with the reason as a sentence. Any thread; locks for
    /// a moment.
    device::Safety safety() const override;
    /// Values that measure() took; empty without a drive.
    const TimeHistogram* cycleJitter() const noexcept override { return &jitter_; }
    /// The source is asked for its first set-point in the next cycle.
    /// Errors: those of device::checkNormal(); resource_unavailable (another source moves the arm,
    ///         or its ended() was not called yet).
    Result<void> attach(std::shared_ptr<device::SetPointSource> source) override;
    /// The source that moves the arm gets EndCause::stopped once the measured arm stands; without a
    /// source it does nothing.
    void stop() noexcept override;
    /// Does nothing if the safety state is normal.
    /// Errors: connection_lost (disconnected), device_fault (button still pressed, or the arm still
    ///         brakes).
    Result<void> resetFault() override;
    /// Callbacks run in dispatch(), on its thread.
    device::Registration onSafetyChange(SafetyCallback callback) override {
        return reported_.onChange(std::move(callback));
    }

    /// One period of the controller. Neither locks, allocates, logs nor throws.
    /// Order within it: acts of people, the source's next set-point and its check or braking, the
    /// lag, the new state, the end of a source.
    /// \param scheduled begin of the cycle by the TimeBase
    /// \param missed    cycles so far that began more than one period late
    /// \return whether dispatch() has something to report
    bool cycle(SteadyTime scheduled, std::uint64_t missed) noexcept;
    /// Notes how late the cycle thread woke up, for cycleJitter(). Cycle thread only.
    void measure(std::chrono::nanoseconds late) noexcept {
        jitter_.add(std::chrono::duration<double>(late).count());
    }

    /// Calls ended() of a released source and the safety callbacks. Not from the cycle thread.
    /// Safety callbacks come first, then ended(). Allocates; may be called at any time, also if
    /// there is nothing to report.
    void dispatch();

    /// Runs cycle() on a time base of its own, then dispatch(): for tests with time moved by hand.
    /// Time begins at SteadyTime{} and advances by one period with each call; nothing waits.
    void step();

    /// Stops the arm, as its controller would after a collision. This and the next acts of people
    /// and accidents take effect in the next cycle. Any thread.
    /// \param text the controller's reason
    void protectiveStop(std::string text);
    /// Presses or releases the button; a pressed one stops the arm.
    void emergencyStop(EmergencyStop button) noexcept;
    /// Lets the controller be gone: the safety state is disconnected.
    /// A source that moves the arm ends with EndCause::disconnected.
    void disconnect() noexcept;
    /// The arm answers again; its safety state is normal if there is no other reason for a stop.
    /// The arm has braked meanwhile.
    void reconnect() noexcept;
    /// Moves the arm to a position as if somebody pushed it there. Ignored while a source moves it.
    /// Limits are not checked, and the arm is there at once. Only the newest of several calls
    /// before a cycle counts. One thread at a time.
    /// \param position [rad], one value per axis
    void moveByHand(const device::JointArray& position) noexcept;

private:
    /// Source of a stop; decides what safety() says.
    enum class Cause : std::uint8_t { none, violation, external, emergency, disconnected };
    struct StopReason {
        Cause cause = Cause::none;
        Violation violation;
    };

    explicit JointSimulator(JointSimulatorOptions options);

    // The parts of a cycle, in the order of their calls. All run on the cycle thread.
    void takeRequests() noexcept;
    void takeHandMove() noexcept;
    void enter(device::SafetyState safety, const StopReason& reason) noexcept;
    void move() noexcept;
    void follow(device::SetPointSource& source) noexcept;
    void judge(const device::JointArray& set_point) noexcept;
    void endWhenDue() noexcept;
    void end(device::EndCause cause) noexcept;
    /// Whether each measured axis is slower than standstill_speed_.
    bool measuredStands() const noexcept;
    /// Whether commanded and measured arm stand, at the same place within 0.0001 rad.
    bool cameToRest() const noexcept;
    void publish(SteadyTime scheduled, std::uint64_t missed) noexcept;
    /// Calls ended() of the source that was released, once, without the lock.
    void tellEnd();

    const device::ArmInfo info_;
    const double standstill_speed_;

    // Cycle thread only:
    Guard guard_;
    Lag lag_;
    device::ArmState state_;
    bool stopping_ = false;
    device::SafetyState last_safety_ = device::SafetyState::normal;

    // Shared by the cycle thread and the others:
    device::SharedValue<device::ArmState> published_;
    TimeHistogram jitter_;
    device::SharedValue<StopReason> reason_;
    std::atomic<device::SafetyState> safety_{device::SafetyState::normal};
    std::atomic<bool> standing_{true};
    // The source that the cycle asks. owner_ keeps it alive until dispatch() has called its
    // ended(), so the cycle thread never sees one that is gone.
    std::atomic<device::SetPointSource*> active_{nullptr};
    std::atomic<device::SetPointSource*> stop_target_{nullptr};
    std::atomic<bool> ended_{false};
    std::atomic<device::EndCause> end_cause_{device::EndCause::done};
    std::atomic<bool> protective_requested_{false};
    std::atomic<bool> emergency_pressed_{false};
    std::atomic<bool> link_cut_{false};
    LatestValue<device::JointArray> hand_move_;

    // All threads but the cycle thread:
    mutable std::mutex mutex_;
    std::shared_ptr<device::SetPointSource> owner_;  // shared with the caller of attach()
    std::string external_text_;
    device::SafetyPublisher reported_{device::Safety{}};  ///< as of the last dispatch()
    std::uint64_t steps_ = 0;
};

}  // namespace metier::joint_simulator
