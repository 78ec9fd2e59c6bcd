#pragma once

#include <open62541/plugin/eventloop.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"
#include "metier/base/histogram.hpp"

namespace metier::opcua {

class Loop;

/// A TCP connection of the loop; never used again for another. 0: none.
using ConnectionId = std::uintptr_t;

struct EventLoopOptions {
    std::size_t send_queue_limit = std::size_t{8} << 20U;  ///< [byte] per peer, beyond: cut
    std::chrono::milliseconds stall_limit{2000};  ///< a peer that takes nothing so long is cut
    /// Longest time for an outgoing connection to open
    std::chrono::milliseconds connect_limit{5000};
    std::size_t max_connections = 1000;  ///< beyond: accepted and closed at once
    /// Longest time until a peer must be admitted; a stranger is closed earlier if its place is
    /// needed. 0: every peer counts as admitted.
    std::chrono::milliseconds stranger_limit{0};
    int kernel_send_buffer = 0;         ///< [byte] SO_SNDBUF, 0: as the kernel chooses
    const UA_Logger* logger = nullptr;  ///< must outlive the loop; none: silent
};

struct EventLoopStatistics {
    std::size_t connections = 0;   ///< open now, accepted and outgoing
    std::size_t queued_bytes = 0;  ///< [byte] waiting for peers to read, now
    std::uint64_t accepted = 0;
    std::uint64_t refused = 0;            ///< beyond max_connections
    std::uint64_t dropped_strangers = 0;  ///< closed, not admitted in time or its place was needed
    std::uint64_t cut_peers = 0;          ///< did not take what was sent to them
    std::uint64_t flushes = 0;            ///< publish callbacks run at once
    std::uint64_t fruitless_flushes = 0;  ///< of these, without anything to publish
    std::uint64_t iterations = 0;
};

struct ListenAddress {
    std::string address;  ///< as it was asked for; empty: all interfaces
    std::uint16_t port = 0;
};

/// An EventLoop for open62541 on Asio, with its TCP ConnectionManager, for servers and clients.
///
/// Sends never wait: what a peer does not take at once is queued, and a peer that takes nothing
/// for `stall_limit`, or is owed more than `send_queue_limit`, is cut. Listening sockets never
/// share a port, and a restart needs no waiting. Only TCP: other event sources are refused.
///
/// Ownership: this object owns the loop's memory, always; the stack's `free` only ends the stack's
/// use of it. A server uses `externalEventLoop` false, the default: UA_Server_run_shutdown then
/// drains and stops the loop (with true, open62541 1.4 never reaches the state Stopped, so the
/// server cannot be deleted). A client alone on its loop uses false, too. Clients that share a
/// server's loop need `externalEventLoop` true, and are deleted before the server is shut down.
/// Destroy the loop after the servers and clients that use it.
///
/// Threading: one owner thread calls everything but post() and lastIteration(), which any thread
/// may call. The stack's own mutex (recursive, as its interface demands) is held whenever the loop
/// does not wait, so that stack calls from another thread stay legal; the architecture has none.
/// Functions given to post() and callbacks must not run the loop again.
class AsioEventLoop {
public:
    explicit AsioEventLoop(EventLoopOptions options = {});
    /// Stops the loop, closes what is open, runs the work the stack put off.
    ~AsioEventLoop();
    AsioEventLoop(const AsioEventLoop&) = delete;
    AsioEventLoop& operator=(const AsioEventLoop&) = delete;

    /// For UA_ServerConfig::eventLoop or UA_ClientConfig::eventLoop; set it before the default
    /// configuration is made.
    UA_EventLoop* handle() noexcept;

    /// Runs `work` on the owner thread in the loop's next iteration, which it wakes. What it
    /// throws ends that iteration with an error.
    /// Threads: any.
    void post(std::function<void()> work);

    /// Handles what is due, waiting at most `timeout` for something to be.
    /// Errors: internal (not started, called from a callback, or a handler threw).
    Result<> runOnce(std::chrono::milliseconds timeout);

    /// The accepted connection whose message is being processed, 0 outside of one.
    ConnectionId currentConnection() const noexcept;

    /// The peer of an accepted connection showed a certificate that is trusted: others lose their
    /// place first.
    void vouchFor(ConnectionId connection);
    /// The connection has a Session, or one more: it keeps its place.
    void admit(ConnectionId connection);
    /// The connection has one Session less; without any it is as good as vouched for.
    void dismiss(ConnectionId connection);

    /// Time that the owner thread has worked, without waiting, on the data that it last read from a
    /// peer; 0 at other times. Owner thread.
    std::chrono::nanoseconds workOnTurn() const;

    /// Publishes the waiting notifications of the Subscriptions of these connections, right after
    /// the handlers that run now. Ask only for connections that have a MonitoredItem for the event:
    /// a publish callback without a notification counts towards the Subscription's keep-alive.
    /// Connections without a queued PublishRequest are published to when the next one arrives. A
    /// connection also stands for the Subscriptions that were created on it and have moved to
    /// another one since.
    ///
    /// Subscriptions are recognised by this rule: the first cyclic callback with data that is added
    /// while a message of an accepted connection is processed must be a Subscription's publish
    /// callback. So add no repeated server callback inside a method or read callback.
    void flushPublishing(std::span<const ConnectionId> connections);

    /// Closes the connections that were opened from here. What their peers have not taken yet is
    /// dropped, also by the kernel: nothing of it arrives when a cut network comes back.
    void dropOpened();

    EventLoopStatistics statistics() const;
    /// Addresses on which the loop listens, with the real port if 0 was asked for.
    std::vector<ListenAddress> listening() const;
    /// Why listening or connecting failed last, with address and port; empty: it never did.
    std::string lastNetworkError() const;
    /// Time of the loop's last activity: the start of an iteration or of a flush. A loop in use
    /// without work iterates at least as often as its owner's timeout.
    /// Threads: any.
    SteadyTime lastIteration() const noexcept;
    /// Times from flushPublishing() until the notifications were handed to the sockets, one per
    /// Subscription.
    /// Threads: any.
    const TimeHistogram& publishLatency() const noexcept;

private:
    std::unique_ptr<Loop> loop_;
};

}  // namespace metier::opcua
