#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "metier/device/arm.hpp"

namespace metier::device {

/// Safety state of a device, and the callbacks that hear of its changes. Changes that follow each
/// other between two calls of dispatch() are reported together, by the last state.
///
/// Threading: any thread; dispatch() always on the same one, which calls the callbacks without a
/// lock. All but state() and toTell() lock, so a cycle thread may call only these two.
///
///     safety.set({SafetyState::protective_stop, "arm: collision on axis 3"});  // driver's thread
///     if (safety.toTell()) { notifier.signal(); }  // cycle thread
///     safety.dispatch();  // notifying thread
class SafetyPublisher {
public:
    /// Callback with the newest state; runs on the thread that calls dispatch().
    using Callback = std::function<void(const Safety&)>;

    /// \param initial state that counts as reported
    explicit SafetyPublisher(Safety initial);

    /// Newest state with its reason. Locks.
    Safety safety() const;
    /// Newest state; neither locks nor allocates.
    SafetyState state() const noexcept { return state_.load(); }
    /// Sets the state and its reason. A new reason for the same state is not reported, only shown
    /// by safety().
    /// Any thread but a cycle thread. A change that is undone before dispatch() is not reported at
    /// all.
    void set(Safety safety);
    /// Reports whether dispatch() has a change to publish.
    bool toTell() const noexcept { return changed_.load(); }
    /// Calls the callbacks, in the order of their onChange(), if the state differs from the one
    /// that they got last.
    /// A callback may register or end registrations; these count from the next change on.
    void dispatch();
    /// Calls `callback` from dispatch() until the registration ends, which may outlive this.
    Registration onChange(Callback callback);

private:
    /// Callbacks in the order of their registration, each with a number by which it is removed.
    struct Listeners {
        std::mutex mutex;
        std::vector<std::pair<std::uint64_t, Callback>> callbacks;
        std::uint64_t next = 1;
    };

    // known_ is the newest state, reported_ the one that the callbacks got last; mutex_ guards
    // both. No lock is held while a callback runs.
    std::atomic<SafetyState> state_;
    std::atomic<bool> changed_{false};
    mutable std::mutex mutex_;
    Safety known_;
    SafetyState reported_;
    // Shared with the registrations, which take themselves off it.
    const std::shared_ptr<Listeners> listeners_ = std::make_shared<Listeners>();
};

}  // namespace metier::device
