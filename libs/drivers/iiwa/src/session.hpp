#pragma once

#include <array>
#include <chrono>
#include <functional>
#include <stop_token>

#include "flange_force.hpp"
#include "metier/iiwa_driver/iiwa_arm.hpp"
#include "metier/link/link_guard.hpp"
#include "metier/link/tcp_link.hpp"
#include "motion_commander.hpp"

namespace metier::iiwa_driver {

/// Waits until the cabinet connects, then sends one command per cycle and passes its answers on,
/// until the connection is lost; then waits again.
///
/// Threading: run() is the cycle thread.
class Session {
public:
    /// Objects that the session serves; all must outlive it.
    struct Clients {
        MotionCommander& commander;
        FlangeForce& force;
        std::function<void()> signal;  ///< called when there is something to report; neither locks
                                       ///< nor allocates
    };

    /// Port to which the cabinet connects, and the guard that closes the connection if this process
    /// does not work any more.
    struct Links {
        link::TcpListener listener;
        link::LinkGuard guard;
    };

    Session(Links links, Clients clients, const IiwaOptions& options);

    std::uint16_t port() const { return links_.listener.port(); }
    /// Runs until `stop` is requested; ends within one cycle after it.
    void run(const std::stop_token& stop);
    /// Any thread: ends waiting for the cabinet.
    void shutdown() noexcept { links_.listener.shutdown(); }

private:
    void serve(link::TcpLink& link, const std::stop_token& stop);
    Result<void> poll(link::TcpLink& link, const std::stop_token& stop);
    Result<void> keepGuard(link::TcpLink& link);
    Result<CabinetState> exchange(link::TcpLink& link, const Command& command,
                                  std::chrono::nanoseconds timeout);
    void awaitCycle(SteadyTime& scheduled);

    Links links_;
    Clients clients_;
    const IiwaOptions options_;
    bool answered_ = false;  ///< the cabinet has answered on this connection
    bool guarded_ = false;   ///< this connection
    std::array<std::byte, kLongestState + 1> buffer_{};
};

}  // namespace metier::iiwa_driver
