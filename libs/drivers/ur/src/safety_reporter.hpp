#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <mutex>
#include <optional>
#include <string>

#include "controller_state.hpp"
#include "metier/base/clock.hpp"
#include "metier/device/arm_core.hpp"
#include "primary.hpp"

namespace metier::ur_driver {

/// Safety for two modes; its text says what a person must know and do so that the arm may move.
/// State normal and no text if it may move. The text does not name the device.
device::Safety judge(RobotMode robot_mode, SafetyMode safety_mode);

/// Joins everything that decides whether the arm may move: the controller's modes, its messages,
/// the driver's own stops, and the link. Sets the safety of the ArmCore whenever that changes.
///
/// Threading: any thread; observe() neither locks nor allocates unless the modes changed.
class SafetyReporter {
public:
    /// \param tell called after each change, on the thread that made it; must not lock
    SafetyReporter(device::ArmCore& core, std::function<void()> tell);

    /// Takes a data package.
    /// \param limit_broken whether a set-point had been too fast before
    void observe(const ControllerState& now, bool limit_broken, SteadyTime stamp);
    /// Notes that the link is gone or was not made.
    /// \param why names the peer
    void disconnected(const std::string& why, SteadyTime now);
    /// Notes that the driver stopped the arm; that holds until unlatch().
    void latch(const std::string& why, SteadyTime now);
    void unlatch();
    bool latched() const;
    /// Takes a message of the controller: it is added to the reason of a stop shortly before or
    /// soon after it.
    void report(const primary::Report& report, SteadyTime now);
    /// Sets a text that a person should know although the arm may move; empty: none.
    void note(const std::string& text);
    /// Time of the last change of the safety state.
    SteadyTime since() const;

private:
    struct Modes {
        RobotMode robot = RobotMode::no_controller;
        SafetyMode safety = SafetyMode::undefined;
        friend bool operator==(const Modes&, const Modes&) = default;
    };

    device::Safety compose() const;
    /// Call it with mutex_ held.
    void update(SteadyTime now);

    device::ArmCore& core_;
    const std::function<void()> tell_;
    std::atomic<bool> connected_{false};
    Modes seen_;  // used by the observing thread only

    mutable std::mutex mutex_;
    Modes modes_;
    std::string link_text_;
    std::string latch_text_;
    std::string note_;
    std::string report_text_;
    SteadyTime report_stamp_{};
    SteadyTime since_{};
    device::SafetyState last_ = device::SafetyState::disconnected;
    bool limit_broken_ = false;
};

}  // namespace metier::ur_driver
