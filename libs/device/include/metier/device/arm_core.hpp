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
/// Notifier that calls dispatch() whenever toTell() is true.
///
/// Threading: stated for each group of functions below. Only attach(), safety(), onSafetyChange(),
///            setSafety() and dispatch() lock.
class ArmCore {
public:
    explicit ArmCore(ArmInfo info);
    /// Ends a source that is still attached with EndCause::disconnected.
    ~ArmCore();
    ArmCore(const ArmCore&) = delete;
    ArmCore& operator=(const ArmCore&) = delete;

    // ---- for device::Arm; any thread ----
    const ArmInfo& info() const noexcept { return info_; }
    ArmState state() const noexcept { return published_.read(); }
    Safety safety() const { return safety_.safety(); }
    const TimeHistogram* cycleJitter() const noexcept { return &jitter_; }
    /// Errors: device_fault if the safety state is not normal, resource_unavailable while another
    ///         source is attached.
    Result<void> attach(std::shared_ptr<SetPointSource> source);
    /// Asks the cycle thread to stop the source that is active now; neither locks nor waits.
    void stop() noexcept;
    Registration onSafetyChange(Arm::SafetyCallback callback);

    // ---- for the cycle thread; these neither lock, allocate, log nor throw ----
    /// Source that moves the arm now; nullptr if there is none.
    SetPointSource* active() const noexcept { return active_.load(); }
    /// Reports whether the active source must be stopped. Stays true until end().
    bool stopRequested() noexcept;
    /// Publishes the state; this fills in its safety.
    void publish(ArmState state) noexcept;
    /// Lets go of the active source. Call publish() with the state at the end before it.
    void end(EndCause cause) noexcept;
    /// Safety state without its text, for the cycle thread.
    SafetyState safetyState() const noexcept { return safety_.state(); }
    /// Reports whether dispatch() has something to report.
    bool toTell() const noexcept { return ended_.load() || safety_.toTell(); }

    // ---- any thread, off the cycle's normal path: they lock ----
    /// Sets the safety state. The text should name the device and the reason.
    void setSafety(Safety safety);
    /// Calls the safety callbacks and ended() of a source that the cycle thread has let go of. Only
    /// the notifier's thread may call it.
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
};

}  // namespace metier::device
