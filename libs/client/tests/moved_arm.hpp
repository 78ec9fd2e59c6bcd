#pragma once

#include <chrono>
#include <cmath>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "metier/base/clock.hpp"
#include "metier/client/remote_arm.hpp"
#include "metier/device/arm.hpp"

namespace metier::client::testing {

using device::EndCause;
using device::SafetyState;

inline SteadyTime soon() {
    return std::chrono::steady_clock::now() + std::chrono::seconds(30);
}

/// Moves axis 1 by `distance` [rad] within `cycles`, smoothly, and waits there for the arm.
class SmoothMove final : public device::SetPointSource {
public:
    SmoothMove(double distance, int cycles) : distance_(distance), cycles_(cycles) {}

    Next next(const device::ArmState& state, device::JointArray& set_point) noexcept override {
        if (!start_) {
            start_ = set_point;
        }
        if (cycle_ >= cycles_) {
            return arrived(state) ? Next::done : Next::set_point;
        }
        ++cycle_;
        const double part = static_cast<double>(cycle_) / cycles_;
        set_point[0] =
            (*start_)[0] + distance_ * part * part * part * (10.0 + part * (6.0 * part - 15.0));
        return Next::set_point;
    }

    void ended(EndCause cause, const device::Safety& safety) override {
        if (on_end_) {
            on_end_();
        }
        {
            const std::lock_guard lock(mutex_);
            cause_ = cause;
            text_ = safety.text;
        }
        changed_.notify_all();
    }

    /// Why the arm let go; nothing within 30 s.
    std::optional<EndCause> awaitEnd() {
        std::unique_lock lock(mutex_);
        changed_.wait_until(lock, soon(), [this] { return cause_.has_value(); });
        return cause_;
    }
    std::string text() {
        const std::lock_guard lock(mutex_);
        return text_;
    }
    /// Called when the arm lets go, on its thread. Before the source is attached.
    void onEnd(std::function<void()> on_end) { on_end_ = std::move(on_end); }

private:
    bool arrived(const device::ArmState& state) const noexcept {
        return state.standstill && std::abs(state.position[0] - (*start_)[0] - distance_) < 1e-3;
    }

    const double distance_;
    const int cycles_;
    int cycle_ = 0;
    std::optional<device::JointArray> start_;
    std::function<void()> on_end_;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::optional<EndCause> cause_;
    std::string text_;
};

/// Looks at the arm's state until it fits; false after 30 s.
template <typename Fits>
bool awaitState(const RemoteArm& arm, Fits fits) {
    const auto deadline = soon();
    while (!fits(arm.state())) {
        if (std::chrono::steady_clock::now() > deadline) {
            return false;
        }
        std::this_thread::yield();
    }
    return true;
}

/// Waits until the arm reports that state; false after 30 s.
inline bool awaitSafety(RemoteArm& arm, SafetyState wanted) {
    struct News {
        std::mutex mutex;
        std::condition_variable changed;
    };
    const auto news = std::make_shared<News>();  // with a call that may end after the registration
    const auto watch = arm.onSafetyChange([news](const device::Safety&) {
        const std::lock_guard lock(news->mutex);
        news->changed.notify_all();
    });
    std::unique_lock lock(news->mutex);
    return news->changed.wait_until(lock, soon(), [&] { return arm.safety().state == wanted; });
}

/// Asks for a reset until its outcome is there, at most 30 s.
inline Result<void> resetUntilDone(RemoteArm& arm) {
    const auto deadline = soon();
    auto reset = arm.resetFault();
    while (!reset && reset.error().code == Errc::timeout &&
           std::chrono::steady_clock::now() < deadline) {
        std::this_thread::yield();
        reset = arm.resetFault();
    }
    return reset;
}

}  // namespace metier::client::testing
