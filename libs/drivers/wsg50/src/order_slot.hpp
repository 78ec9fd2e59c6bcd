#pragma once

#include <atomic>
#include <mutex>
#include <optional>

#include "metier/base/error.hpp"
#include "metier/device/gripper.hpp"
#include "motion_task.hpp"

namespace metier::wsg50_driver {

/// Orders on their way from any thread to the one that talks to the gripper, and their outcomes on
/// the way back.
class OrderSlot {
public:
    // ---- any thread ----
    /// Errors: resource_unavailable; what close() was given.
    Result<void> ask(const Motion& motion, device::Gripper::Done done);
    void askStop() noexcept { stop_.store(true); }

    // ---- the talking thread ----
    /// From now on motions are accepted.
    void open();
    /// From now on none is accepted; one that was, still is to be ended.
    void close(Error why);
    /// A motion that was accepted and not taken yet.
    std::optional<Motion> takeMotion();
    /// Whether a motion was accepted and not ended.
    bool occupied() const;
    bool takeStop() noexcept { return stop_.exchange(false); }
    /// Ends the motion that was accepted, if there is one.
    void endMotion(Result<device::GripperOutcome> outcome);

    // ---- the notifying thread ----
    /// Tells the outcome to whoever asked for the motion.
    void dispatch();

private:
    mutable std::mutex mutex_;
    std::optional<Error> closed_{Error{Errc::connection_lost, "not connected yet"}};
    std::optional<Motion> asked_;
    device::Gripper::Done done_;
    std::optional<Result<device::GripperOutcome>> outcome_;
    std::atomic<bool> stop_{false};
};

}  // namespace metier::wsg50_driver
