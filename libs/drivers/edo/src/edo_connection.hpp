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

/// One e.DO behind one connection, which is made again whenever it is lost. The arm and the gripper
/// are faces of it, and take turns: while a source moves the arm the jaws are refused with
/// resource_unavailable, and the other way round.
///
/// Threading: every function from any thread.
class EdoConnection {
public:
    /// Begins to connect at once.
    explicit EdoConnection(EdoOptions options);
    /// Brakes what moves and gives control back, which takes up to 2 s.
    ~EdoConnection();
    EdoConnection(const EdoConnection&) = delete;
    EdoConnection& operator=(const EdoConnection&) = delete;

    const EdoOptions& options() const noexcept { return options_; }
    device::ArmCore& core() noexcept { return core_; }

    /// Same as device::Arm::attach().
    Result<void> attach(std::shared_ptr<device::SetPointSource> source);
    /// Begins a motion of the jaws, as device::Gripper does.
    Result<void> moveJaws(GripperTask::Kind kind, const device::GripperRequest& request,
                          device::Gripper::Done done);
    void stopJaws() noexcept { session_.gripperSlot().stop(); }
    device::GripperState gripperState() const noexcept;

    /// Same as device::Arm::resetFault().
    Result<void> resetFault();

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

/// The arm of an e.DO.
class EdoArm final : public device::Arm {
public:
    /// \param connection must outlive this
    explicit EdoArm(EdoConnection& connection) : connection_(connection) {}

    const device::ArmInfo& info() const noexcept override { return core().info(); }
    device::ArmState state() const noexcept override { return core().state(); }
    device::Safety safety() const override { return core().safety(); }
    const TimeHistogram* cycleJitter() const noexcept override { return core().cycleJitter(); }
    Result<void> attach(std::shared_ptr<device::SetPointSource> source) override {
        return connection_.attach(std::move(source));
    }
    void stop() noexcept override { core().stop(); }
    Result<void> resetFault() override { return connection_.resetFault(); }
    device::Registration onSafetyChange(SafetyCallback callback) override {
        return core().onSafetyChange(std::move(callback));
    }

private:
    device::ArmCore& core() const noexcept { return connection_.core(); }

    EdoConnection& connection_;
};

/// The built-in gripper of an e.DO: its last joint. It has no force control and its safety is that
/// of the robot.
class EdoGripper final : public device::Gripper {
public:
    /// \param connection must outlive this
    explicit EdoGripper(EdoConnection& connection);

    const device::GripperInfo& info() const noexcept override { return info_; }
    device::GripperState state() const noexcept override { return connection_.gripperState(); }
    device::Safety safety() const override { return connection_.core().safety(); }
    Result<void> grasp(const device::GripperRequest& request, Done done) override {
        return connection_.moveJaws(GripperTask::Kind::grasp, request, std::move(done));
    }
    Result<void> release(const device::GripperRequest& request, Done done) override {
        return connection_.moveJaws(GripperTask::Kind::release, request, std::move(done));
    }
    Result<void> move(const device::GripperRequest& request, Done done) override {
        return connection_.moveJaws(GripperTask::Kind::move, request, std::move(done));
    }
    void stop() noexcept override { connection_.stopJaws(); }
    Result<void> resetFault() override { return connection_.resetFault(); }
    device::Registration onSafetyChange(SafetyCallback callback) override {
        return connection_.core().onSafetyChange(std::move(callback));
    }

private:
    EdoConnection& connection_;
    device::GripperInfo info_;
};

}  // namespace metier::edo_driver
