#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <thread>

#include "dashboard_reset.hpp"
#include "metier/device/arm_core.hpp"
#include "metier/device/notifier.hpp"
#include "metier/device/reset_slot.hpp"
#include "metier/device/shared_value.hpp"
#include "metier/motion/robot_model.hpp"
#include "panel.hpp"
#include "primary_session.hpp"
#include "rtde_session.hpp"
#include "safety_reporter.hpp"
#include "streamer.hpp"
#include "ur_settings.hpp"

namespace metier::ur_driver {

/// Options of an arm.
struct UrArmOptions {
    std::string name;
    std::string host;
    motion::RobotModel model;  ///< model with six axes, with which the rest of the program plans
    UrSettings settings;       ///< settings, with a frequency > 0
    /// The controller's own velocity limits [rad/s]; zeros if it has not sent them.
    Joints max_velocity{};
};

/// An arm of Universal Robots, of the CB3 and the e-Series: follows set-points by a script that
/// the driver uploads when a source is attached, over RTDE.
///
/// Its cycle is driven by the controller's data packages. It connects, and connects again, by
/// itself; it never moves by itself.
///
/// Metier observes the controller's safety and obeys it; it is not safety-rated.
/// Source: docs/protocols/ur.md.
class UrArm final : public device::Arm {
public:
    explicit UrArm(UrArmOptions options);
    ~UrArm() override = default;
    UrArm(const UrArm&) = delete;
    UrArm& operator=(const UrArm&) = delete;

    const device::ArmInfo& info() const noexcept override { return core_.info(); }
    device::ArmState state() const noexcept override { return core_.state(); }
    device::Safety safety() const override { return core_.safety(); }
    const TimeHistogram* cycleJitter() const noexcept override { return core_.cycleJitter(); }
    /// Errors: also device_fault if the speed slider is below 100 % or the controller runs a
    ///         program that is not this driver's.
    Result<void> attach(std::shared_ptr<device::SetPointSource> source) override;
    void stop() noexcept override { core_.stop(); }
    Result<void> resetFault() override;
    device::Registration onSafetyChange(SafetyCallback callback) override {
        return core_.onSafetyChange(std::move(callback));
    }

private:
    void run(const std::stop_token& stop);
    /// \return why the session ended
    Error serve(RtdeSession& session, const std::stop_token& stop);
    Result<void> cycle(RtdeSession& session, const ControllerState& now);
    void lost(const Error& why);
    void notify();
    void hear(const primary::Package& package);

    const UrArmOptions options_;
    const std::chrono::nanoseconds link_timeout_;
    device::ArmCore core_;
    PanelJobs jobs_;
    SafetyReporter reporter_;
    Streamer streamer_;
    device::SharedValue<Observation> observed_;
    std::atomic<std::int32_t> upload_{0};
    std::atomic<bool> stop_program_{false};
    ControllerDescription description_;  // primary monitor's thread only
    ControllerDescription compared_;     // primary monitor's thread only

    device::ResetSlot resets_;

    // Ended in this order from below: who signals before who is signalled.
    device::Notifier notifier_;
    Panel panel_;
    PrimaryMonitor primary_;
    std::jthread thread_;
};

}  // namespace metier::ur_driver
