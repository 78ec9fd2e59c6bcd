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

/// The safety state of a device, and who hears of its changes.
///
/// Threading: any thread, but dispatch() one thread alone. Only state() and toTell() do not lock.
class SafetyPublisher {
public:
    using Callback = std::function<void(const Safety&)>;

    explicit SafetyPublisher(Safety initial);

    Safety safety() const;
    SafetyState state() const noexcept { return state_.load(); }
    /// A change of state or reason.
    void set(Safety safety);
    /// Whether dispatch() has something to tell.
    bool toTell() const noexcept { return changed_.load(); }
    /// Tells the callbacks if the state is another than the one they know.
    void dispatch();
    /// Calls `callback` from dispatch(). The registration may outlive this.
    Registration onChange(Callback callback);

private:
    struct Listeners {
        std::mutex mutex;
        std::vector<std::pair<std::uint64_t, Callback>> callbacks;
        std::uint64_t next = 1;
    };

    std::atomic<SafetyState> state_;
    std::atomic<bool> changed_{false};
    mutable std::mutex mutex_;
    Safety known_;
    SafetyState reported_;
    // Shared with the registrations, which take themselves off it.
    const std::shared_ptr<Listeners> listeners_ = std::make_shared<Listeners>();
};

}  // namespace metier::device
