#pragma once

#include <memory>
#include <mutex>
#include <stop_token>
#include <thread>

#include "metier/device/arm_core.hpp"
#include "metier/device/gripper.hpp"
#include "metier/device/notifier.hpp"
#include "metier/edo_driver/websocket_link.hpp"
#include "session.hpp"

namespace metier::edo_driver {

/// An e.DO behind one connection, which is made again whenever it is lost. The arm and its gripper
/// take turns: while a source moves the arm the jaws are refused with resource_unavailable, and the
/// other way round.
///
/// Threading: every function from any thread.
class EdoArm final : public device::Arm {
public:
    /// Begins to connect at once.
    explicit EdoArm(EdoOptions options);
    /// Brakes what moves and gives control back, which takes up to 2 s.
    ~EdoArm() override;
    EdoArm(const EdoArm&) = delete;
    EdoArm& operator=(const EdoArm&) = delete;

    const device::ArmInfo& info() const noexcept override { return core_.info(); }
    device::ArmState state() const noexcept override { return core_.state(); }
    device::Safety safety() const override { return core_.safety(); }
    const TimeHistogram* cycleJitter() const noexcept override { return core_.cycleJitter(); }
    Result<void> attach(std::shared_ptr<device::SetPointSource> source) override;
    void stop() noexcept override { core_.stop(); }
    Result<void> resetFault() override;
    device::Registration onSafetyChange(SafetyCallback callback) override {
        return core_.onSafetyChange(std::move(callback));
    }

    const EdoOptions& options() const noexcept { return options_; }
    /// Begins a motion of the jaws, as device::Gripper does.
    Result<void> moveJaws(GripperTask::Kind kind, const device::GripperRequest& request,
                          device::Gripper::Done done);
    void stopJaws() noexcept { session_.gripperSlot().stop(); }
    device::GripperState gripperState() const noexcept;

private:
    class LinkWire;

    void run(const std::stop_token& stop);
    Result<void> serve(WebSocketLink& link, const std::stop_token& stop);
    Result<void> step(WebSocketLink& link, LinkWire& wire);
    void close(WebSocketLink& link, LinkWire& wire);
    void tell() noexcept;

    const EdoOptions options_;
    device::ArmCore core_;
    Session session_;
    std::mutex turn_;  // held while a user is given the joints
    device::Notifier notifier_;
    std::jthread thread_;
};

/// The built-in gripper of an e.DO: its last joint. It has no force control and its safety is that
/// of the robot.
class EdoGripper final : public device::Gripper {
public:
    /// \param arm must outlive this
    explicit EdoGripper(EdoArm& arm)
        : arm_(arm),
          info_{.name = arm.options().name + " gripper",
                .stroke = arm.options().gripper.stroke,
                .max_speed = arm.options().gripper.speed} {}

    const device::GripperInfo& info() const noexcept override { return info_; }
    device::GripperState state() const noexcept override { return arm_.gripperState(); }
    device::Safety safety() const override { return arm_.safety(); }
    Result<void> grasp(const device::GripperRequest& request, Done done) override {
        return arm_.moveJaws(GripperTask::Kind::grasp, request, std::move(done));
    }
    Result<void> release(const device::GripperRequest& request, Done done) override {
        return arm_.moveJaws(GripperTask::Kind::release, request, std::move(done));
    }
    Result<void> move(const device::GripperRequest& request, Done done) override {
        return arm_.moveJaws(GripperTask::Kind::move, request, std::move(done));
    }
    void stop() noexcept override { arm_.stopJaws(); }
    Result<void> resetFault() override { return arm_.resetFault(); }
    device::Registration onSafetyChange(SafetyCallback callback) override {
        return arm_.onSafetyChange(std::move(callback));
    }

private:
    EdoArm& arm_;
    device::GripperInfo info_;
};

}  // namespace metier::edo_driver
