#pragma once

#include <atomic>
#include <stop_token>
#include <string>
#include <thread>

#include "metier/device/gripper.hpp"
#include "metier/device/notifier.hpp"
#include "metier/device/request_slot.hpp"
#include "metier/device/reset_slot.hpp"
#include "metier/device/safety_publisher.hpp"
#include "metier/device/shared_value.hpp"
#include "metier/link/tcp_link.hpp"
#include "requests.hpp"

namespace metier::wsg50_driver {

/// A Weiss WSG 50 gripper over TCP. Connects, and connects again, by itself.
///
/// A fault that the gripper shows stays until resetFault(), which acknowledges it and, if the
/// gripper is not referenced, homes it. info() holds the usual limits until the first connection.
class Wsg50Gripper final : public device::Gripper, private ConversationListener {
public:
    explicit Wsg50Gripper(Wsg50Options options);
    /// Stops a motion and takes leave of the gripper, so that it does not fall into a fault.
    ~Wsg50Gripper() override;
    Wsg50Gripper(const Wsg50Gripper&) = delete;
    Wsg50Gripper& operator=(const Wsg50Gripper&) = delete;

    const device::GripperInfo& info() const noexcept override { return *info_.load(); }
    device::GripperState state() const noexcept override { return state_.read(); }
    device::Safety safety() const override { return safety_.safety(); }
    Result<void> grasp(const device::GripperRequest& request, Done done) override {
        return ask(MotionKind::grasp, request, std::move(done));
    }
    Result<void> release(const device::GripperRequest& request, Done done) override {
        return ask(MotionKind::release, request, std::move(done));
    }
    Result<void> move(const device::GripperRequest& request, Done done) override {
        return ask(MotionKind::move, request, std::move(done));
    }
    void stop() noexcept override { slot_.stop(); }
    Result<void> resetFault() override;
    device::Registration onSafetyChange(SafetyCallback callback) override {
        return safety_.onChange(std::move(callback));
    }

private:
    Result<void> ask(MotionKind kind, const device::GripperRequest& request, Done done);

    // ---- the thread that talks to the gripper ----
    void run(const std::stop_token& stop);
    /// One connection, from begin to end. Errors: why it ended; nothing if it was to end.
    Result<void> connection(const std::stop_token& stop);
    Result<void> talk(const std::stop_token& stop, Conversation& conversation);
    Result<void> takeBytes(Conversation& conversation, FrameReader& reader);
    Result<void> atPeer(const Error& error) const;
    void passOrders(Conversation& conversation);
    void takeLeave();
    void lost(const Error& why);
    std::string named(std::string_view text) const;
    void publish(device::GripperState state);
    void setSafety(device::Safety safety);

    void send(Command command) override;
    void onLimits(const Limits& limits, double force_limit) override;
    void onState(const device::GripperState& state) override;
    void onSafety(device::Safety safety) override;
    void onMotionEnd(Result<device::GripperOutcome> outcome) override;
    void onResetEnd(Result<void> outcome) override;

    const Wsg50Options options_;
    const device::GripperInfo usual_info_;
    device::GripperInfo read_info_;
    std::atomic<const device::GripperInfo*> info_{&usual_info_};  // later read_info_, once filled
    device::SharedValue<Known> known_;
    device::SharedValue<device::GripperState> state_;
    device::SafetyPublisher safety_;
    device::RequestSlot<Motion, Result<device::GripperOutcome>> slot_;
    device::ResetSlot resets_;

    link::TcpLink* link_ = nullptr;  // during a connection
    Result<void> sent_;              // the first failure of this connection
    bool answered_ = false;          // this connection got as far as the limits

    device::Notifier notifier_;
    std::jthread thread_;
};

}  // namespace metier::wsg50_driver
