#pragma once

#include <atomic>
#include <memory>
#include <mutex>

#include "metier/device/arm.hpp"
#include "metier/device/safety_publisher.hpp"
#include "metier/device/shared_value.hpp"

namespace metier::device {

/// What every driver of an arm needs besides its wire: who moves the arm, what is published of it,
/// who hears of its safety. A driver forwards the functions of device::Arm to it, and gives it a
/// Notifier that calls dispatch() whenever toTell().
class ArmCore {
public:
    explicit ArmCore(ArmInfo info);
    /// Tells a source that is still attached that the arm is disconnected.
    ~ArmCore();
    ArmCore(const ArmCore&) = delete;
    ArmCore& operator=(const ArmCore&) = delete;

    // ---- for device::Arm; any thread ----
    const ArmInfo& info() const noexcept { return info_; }
    ArmState state() const noexcept { return published_.read(); }
    Safety safety() const { return safety_.safety(); }
    const TimeHistogram* cycleJitter() const noexcept { return &jitter_; }
    Result<void> attach(std::shared_ptr<SetPointSource> source);
    void stop() noexcept;
    Registration onSafetyChange(Arm::SafetyCallback callback);

    // ---- for the cycle thread; these neither lock, allocate, log nor throw ----
    /// Whoever moves the arm now; nullptr if nobody does.
    SetPointSource* active() const noexcept { return active_.load(); }
    /// Whether the active source is to be stopped. True until its end().
    bool stopRequested() noexcept;
    /// Publishes the state; its safety is filled in here.
    void publish(ArmState state) noexcept;
    /// Lets go of the active source; publish() the state of the end before.
    void end(EndCause cause) noexcept;
    SafetyState safetyState() const noexcept { return safety_.state(); }
    /// Whether dispatch() has something to tell.
    bool toTell() const noexcept { return ended_.load() || safety_.toTell(); }

    // ---- any thread, off the cycle's normal path: they lock ----
    /// A change of state or reason. Its text should name the device and why.
    void setSafety(Safety safety);
    /// Tells sources and callbacks what happened. The notifier's thread alone.
    void dispatch();

private:
    void tellEnd();
    void measure(SteadyTime stamp) noexcept;

    const ArmInfo info_;
    SharedValue<ArmState> published_;
    TimeHistogram jitter_;
    SteadyTime last_stamp_{};  // of the cycle thread; none: nothing to compare with
    SafetyPublisher safety_;
    std::atomic<SetPointSource*> active_{nullptr};
    std::atomic<SetPointSource*> stop_target_{nullptr};
    std::atomic<bool> ended_{false};
    std::atomic<EndCause> end_cause_{EndCause::done};
    bool stopping_ = false;  // of the cycle thread

    std::mutex mutex_;
    std::shared_ptr<SetPointSource> owner_;  // shared with whoever attached it
};

}  // namespace metier::device
