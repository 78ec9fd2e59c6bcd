#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>

#include "metier/opcua/client.hpp"
#include "metier/skill/state.hpp"

namespace metier::client {

/// Settings of a control.
struct ControlOptions {
    /// Time without a heartbeat after which the server ends the control, 100 ms to 1 h
    /// (skill::Control); heartbeats are sent every quarter of it.
    std::chrono::milliseconds lease{1'000};
    /// Action of the server on this client's executions when the control is lost.
    skill::OwnerLossAction on_loss = skill::OwnerLossAction::skill_default;
};

/// Control of one controller. Heartbeats keep it alive; the destructor gives it back.
///
///     auto control = ControlHandle::acquire(client, skill.controller()->node, {});
///     if (control) { arm.runWith({.epoch = control->epoch()}, deadline); }
///
/// While it lasts, only sessions of this client may command the skills of the controller; Halt is
/// allowed to everybody. When it is lost the server does `on_loss` with running skills.
///
/// Control is lost with the connection, or when two heartbeats in succession got no answer within a
/// lease each. It is never taken again by itself, even if the Client reconnects: acquire() it anew.
///
/// Threading: a thread of its own sends the heartbeats. Must end before its Client.
class ControlHandle {
public:
    /// Takes control and begins the heartbeats; waits for the server.
    /// \param controller object with the lease's methods, see SkillAddress::controller()
    /// Errors: out_of_range (the lease); locked, with the holder's name if the server publishes it;
    ///         not_found, if the controller has no lease; those of the server.
    static opcua::Answer<ControlHandle> acquire(opcua::Client& client,
                                                const opcua::NodeId& controller,
                                                const ControlOptions& options);
    ControlHandle(ControlHandle&&) noexcept;
    ControlHandle& operator=(ControlHandle&&) noexcept;
    /// Ends the heartbeats and, while control is held, gives it back: waits for the server, at most
    /// the client's time-out. Running skills go on.
    ~ControlHandle();

    /// Epoch of this control, for skill::StartRequest::epoch; never 0.
    std::uint64_t epoch() const noexcept;
    /// Whether control is held, as far as this client knows. Any thread.
    bool held() const noexcept;
    /// Sets a callback that runs once, on the heartbeats' thread, when control is lost; at once, on
    /// the caller's thread, if it is lost already. A later call replaces the callback. It must not
    /// destroy this object.
    void onLost(std::function<void(const opcua::Failure&)> callback);

private:
    class Heart;
    explicit ControlHandle(std::unique_ptr<Heart> heart);
    std::unique_ptr<Heart> heart_;
};

}  // namespace metier::client
