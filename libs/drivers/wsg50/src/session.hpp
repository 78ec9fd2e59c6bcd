#pragma once

#include <stop_token>
#include <thread>

#include "metier/device/notifier.hpp"
#include "metier/device/request_slot.hpp"
#include "metier/device/reset_slot.hpp"
#include "metier/device/safety_publisher.hpp"
#include "metier/device/shared_value.hpp"
#include "metier/link/tcp_link.hpp"
#include "motion_task.hpp"
#include "requests.hpp"
#include "wsg50_gripper.hpp"

namespace metier::wsg50_driver {

/// The thread that talks to the gripper, and all that others see of it.
class Wsg50Gripper::Session final : private ConversationListener {
public:
    explicit Session(Wsg50Options options);
    ~Session() override;
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;

    // ---- for device::Gripper; any thread ----
    const device::GripperInfo& info() const noexcept { return *info_.load(); }
    device::GripperState state() const noexcept { return state_.read(); }
    device::Safety safety() const { return safety_.safety(); }
    Result<void> ask(MotionKind kind, const device::GripperRequest& request, Done done);
    void stop() noexcept { slot_.stop(); }
    Result<void> resetFault();
    device::Registration onSafetyChange(SafetyCallback callback) {
        return safety_.onChange(std::move(callback));
    }

private:
    // ---- the session's thread ----
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
