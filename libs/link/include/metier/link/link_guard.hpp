#pragma once

#include <sys/types.h>

#include <atomic>
#include <chrono>
#include <memory>

#include "metier/base/error.hpp"
#include "metier/link/tcp_link.hpp"

namespace metier::link {

/// Closes a TCP connection when its process exists but does not work: the process was stopped
/// (SIGSTOP), or the thread of the connection is stuck. Made for controllers that stop their device
/// when a connection ends, but wait for ever on a silent one:
///
///     auto guard = LinkGuard::start(std::chrono::milliseconds(100));
///     guard->guard(link);
///     guard->alive();  // in every cycle
///
/// The guard is a small process of its own that holds a copy of the connection and opens nothing
/// else. It ends with its owner. It does not notice when the whole computer stood still.
///
/// Threading: one thread at a time.
class LinkGuard {
public:
    /// \param limit longest time between two calls of alive() while a link is guarded, >= 10 ms
    /// Errors: resource_unavailable if the system has no room for another process.
    static Result<LinkGuard> start(std::chrono::milliseconds limit);

    LinkGuard(LinkGuard&& other) noexcept;
    LinkGuard& operator=(LinkGuard&& other) noexcept;
    /// Ends the guard's process; a guarded link stays open.
    ~LinkGuard();

    /// Guards this link from now on, and no other. After `limit` without alive() the link is
    /// closed; this process sees that as if the peer had closed it. Does not wait.
    /// Errors: resource_unavailable if the guard's process is gone.
    Result<void> guard(TcpLink& link);
    /// Guards no link any more. Call it before the guarded link is destroyed: otherwise the guard's
    /// copy keeps the connection open.
    void release() noexcept;
    /// Shows that this process works. Neither waits, locks nor allocates; a cycle thread may call
    /// it.
    void alive() noexcept { beats_->fetch_add(1, std::memory_order_relaxed); }

    /// Process id of the guard; for tests.
    pid_t pid() const noexcept { return pid_; }

private:
    using Beats = std::atomic<std::uint32_t>;

    LinkGuard(pid_t pid, int channel, Beats* beats) : pid_(pid), channel_(channel), beats_(beats) {}
    void end() noexcept;

    pid_t pid_ = -1;
    int channel_ = -1;        // socket to the guard's process, which ends when this closes
    Beats* beats_ = nullptr;  // in memory that both processes see
};

}  // namespace metier::link
