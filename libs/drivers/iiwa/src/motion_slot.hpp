#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <string>

#include "metier/device/motion_planner.hpp"
#include "controller_planned_run.hpp"

namespace metier::iiwa_driver {

/// Hands one motion at a time from its caller to the cycle thread, and its end back.
class MotionSlot {
public:
    using Done = device::MotionPlanner::Done;

    // ---- any thread ----
    bool occupied() const;
    /// False if it is occupied.
    bool post(const device::ControllerPlannedMotion& motion, Done done);
    void stop() noexcept { stop_target_.store(posted_.load()); }

    // ---- the cycle thread; neither lock nor allocate ----
    /// The motion that is to be done; nullptr if none is.
    const device::ControllerPlannedMotion* posted() const noexcept { return posted_.load(); }
    /// Whether the posted motion is to be stopped. True until its end().
    bool stopRequested() noexcept;
    void end(const RunEnd& end) noexcept;
    /// Whether dispatch() has something to tell.
    bool toTell() const noexcept { return ended_.load(); }

    /// Tells the caller how its motion ended. The notifier's thread alone.
    /// \param name of the device, for texts
    /// \param lost why the connection is gone, for texts
    void dispatch(const std::string& name, const std::string& lost);

private:
    struct Job {
        device::ControllerPlannedMotion motion;
        Done done;
    };

    std::atomic<const device::ControllerPlannedMotion*> posted_{nullptr};
    std::atomic<const device::ControllerPlannedMotion*> stop_target_{nullptr};
    std::atomic<bool> ended_{false};
    RunEnd end_;             // of the cycle thread until ended_
    bool stopping_ = false;  // of the cycle thread

    mutable std::mutex mutex_;
    std::unique_ptr<Job> job_;
};

/// The outcome for the caller. \param lost why the connection is gone
Result<device::MotionOutcome> outcomeOf(const RunEnd& end, const std::string& name,
                                        const std::string& lost);

}  // namespace metier::iiwa_driver
