#pragma once

#include <atomic>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "gripper_drive.hpp"

namespace metier::edo_driver {

/// Where any thread asks for a motion of the jaws, the cycle thread takes it, and the notifying
/// thread tells how it ended.
class GripperSlot {
public:
    using Outcome = Result<device::GripperOutcome>;

    /// Errors: resource_unavailable while a motion runs.
    Result<void> ask(const GripperTask& task, device::Gripper::Done done);
    void askToStop() noexcept { stop_.store(true); }
    /// From ask() until the end of the motion.
    bool busy() const noexcept { return busy_.load(); }

    // ---- for the cycle thread; the first two neither lock nor allocate ----
    bool hasTask() const noexcept { return has_task_.load(); }
    bool stopWanted() noexcept { return stop_.load() && stop_.exchange(false); }
    /// Only if hasTask().
    GripperTask take();
    void finish(Outcome outcome);
    bool toTell() const noexcept { return ended_.load(); }

    /// The notifier's thread alone.
    void dispatch();

private:
    std::atomic<bool> busy_{false};
    std::atomic<bool> has_task_{false};
    std::atomic<bool> stop_{false};
    std::atomic<bool> ended_{false};
    std::mutex mutex_;
    GripperTask task_;
    device::Gripper::Done done_;
    std::vector<std::pair<device::Gripper::Done, Outcome>> to_tell_;
};

}  // namespace metier::edo_driver
