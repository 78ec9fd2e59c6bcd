#pragma once

#include <atomic>
#include <memory>
#include <mutex>

#include "metier/device/arm.hpp"
#include "metier/device/safety_publisher.hpp"
#include "metier/device/shared_value.hpp"

namespace metier::device {

/// Common part of all arm drivers: the attached set-point source, the published state and the
/// callbacks for safety changes. A driver forwards the functions of device::Arm to it, and has a
/// Notifier that calls dispatch() whenever toTell() is true. Its cycle thread does in each cycle:
///
///     if (core.stopRequested()) { ... brake, and core.end(EndCause::stopped) at standstill ... }
///     if (auto* source = core.active()) { ... source->next(state, set_point) ... }
///     core.publish(state);
///     if (core.toTell()) { notifier.signal(); }
///
/// Threading: stated for each group of functions below. Only attach(), safety(), onSafetyChange(),
/// setSafety() and dispatch() lock.
class ArmCore {
public:
    /// Begins disconnected, with all positions 0.
    /// \param info at most kMaxAxes axes
    explicit ArmCore(ArmInfo info);
    /// Ends a source that is still attached with EndCause::disconnected, on this thread. The cycle
    /// thread and the notifier must have ended.
    ~ArmCore();
    ArmCore(const ArmCore&) = delete;
    ArmCore& operator=(const ArmCore&) = delete;

    // ---- for device::Arm; any thread ----
    /// As given to the constructor; valid as long as this.
    const ArmInfo& info() const noexcept { return info_; }
    /// The state that was published last.
    ArmState state() const noexcept { return published_.read(); }
    /// The safety state that was set last, with its text. Locks.
    Safety safety() const { return safety_.safety(); }
    /// Histogram of |time between two published states - period| [s]; times across a lost
    /// connection do not count.
    const TimeHistogram* cycleJitter() const noexcept { return &jitter_; }
    /// Takes a source, which active() shows from now on.
    /// \param source not null
    /// Errors: device_fault if the safety state is not normal, resource_unavailable while another
    ///         source is attached, or its end was not dispatched.
    Result<void> attach(std::shared_ptr<SetPointSource> source);
    /// Asks the cycle thread to stop the source that is active now; neither locks nor waits.
    void stop() noexcept;
    /// Calls `callback` from dispatch() after each change of the safety state; the registration may
    /// outlive this.
    Registration onSafetyChange(Arm::SafetyCallback callback);

    /// Source that moves the arm now; nullptr if there is none. Valid until end().
    SetPointSource* active() const noexcept { return active_.load(); }
    /// Reports whether the active source must be stopped. Stays true until end(). A stop() that was
    /// meant for an earlier source does not count.
    bool stopRequested() noexcept;
    /// Publishes the state; this fills in its safety. The time between two different stamps goes to
    /// cycleJitter().
    void publish(ArmState state) noexcept;
    /// Lets go of the active source; nothing happens if there is none. Call publish() with the
    /// state at the end before it.
    void end(EndCause cause) noexcept;
    /// Safety state without its text, for the cycle thread.
    SafetyState safetyState() const noexcept { return safety_.state(); }
    /// Reports whether dispatch() has something to report.
    bool toTell() const noexcept { return ended_.load() || safety_.toTell(); }

    // ---- any thread, off the cycle's normal path: they lock ----
    /// Sets the safety state. The text should name the device and the reason.
    void setSafety(Safety safety);
    /// Calls the safety callbacks, and then ended() of a source that the cycle thread has let go
    /// of; no lock is held meanwhile. Only the notifier's thread may call it.
    void dispatch();

private:
    void tellEnd();
    void measure(SteadyTime stamp) noexcept;

    const ArmInfo info_;
    SharedValue<ArmState> published_;
    TimeHistogram jitter_;
    SteadyTime last_stamp_{};  // cycle thread only; zero: no state to compare with
    SafetyPublisher safety_;
    std::atomic<SetPointSource*> active_{nullptr};
    std::atomic<SetPointSource*> stop_target_{nullptr};
    std::atomic<bool> ended_{false};
    std::atomic<EndCause> end_cause_{EndCause::done};
    bool stopping_ = false;  // cycle thread only

    std::mutex mutex_;
    std::shared_ptr<SetPointSource> owner_;  // shared with the caller of attach()
    Safety loss_;  // last state since attach() in which the arm could not move
};

}  // namespace metier::device
