#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>

#include "metier/opcua/client.hpp"
#include "metier/skill/state.hpp"

namespace metier::client {

struct ControlOptions {
    /// Until the server takes this client for gone, without a heartbeat; a quarter of it is the
    /// interval of the heartbeats.
    std::chrono::milliseconds lease{1'000};
    skill::OwnerLossAction on_loss = skill::OwnerLossAction::skill_default;
};

/// Control of one controller, kept alive by heartbeats, and given back at the end.
///
/// While it lasts, only sessions of this client may command the skills of the controller; Halt is
/// everybody's. When it is lost the server does with running skills what `on_loss` says.
///
/// Control is lost with the connection, or when two heartbeats in succession get no answer for a
/// lease. It is never taken again by itself, also if the Client reconnects: this time of control is
/// over, and whoever wants another acquires it.
///
/// Threading: a thread of its own sends the heartbeats. Must end before its Client.
class ControlHandle {
public:
    /// \param controller object with the lease's methods, see SkillAddress::controller()
    /// Errors: locked, with the holder's name where the server tells it; not_found, if the
    ///         controller has no lease; the server's.
    static opcua::Answer<ControlHandle> acquire(opcua::Client& client,
                                                const opcua::NodeId& controller,
                                                const ControlOptions& options);
    ControlHandle(ControlHandle&&) noexcept;
    ControlHandle& operator=(ControlHandle&&) noexcept;
    ~ControlHandle();

    /// For StartRequest::epoch.
    std::uint64_t epoch() const noexcept;
    bool held() const noexcept;
    /// `callback` runs once, on the thread of the heartbeats, when control is lost.
    void onLost(std::function<void(const opcua::Failure&)> callback);

private:
    class Heart;
    explicit ControlHandle(std::unique_ptr<Heart> heart);
    std::unique_ptr<Heart> heart_;
};

}  // namespace metier::client
