#pragma once

#include <sys/types.h>

#include <atomic>
#include <chrono>
#include <memory>

#include "metier/base/error.hpp"
#include "metier/link/tcp_link.hpp"

namespace metier::link {

/// Ends a TCP connection when the process that has it does not work, although the system keeps it:
/// it was stopped (SIGSTOP), or the thread of the connection is stuck. For controllers that stop
/// their device when a connection ends, but wait for ever on one that is silent.
///
/// It is a small process of its own that has a copy of the connection. It ends with its owner, and
/// opens nothing else. A computer that stands still as a whole is not noticed.
///
/// Threading: one thread at a time.
class LinkGuard {
public:
    /// \param limit longest time between two calls of alive() while a link is guarded, >= 10 ms
    /// Errors: resource_unavailable if the system has no room for another process.
    static Result<LinkGuard> start(std::chrono::milliseconds limit);

    LinkGuard(LinkGuard&& other) noexcept;
    LinkGuard& operator=(LinkGuard&& other) noexcept;
    /// Ends the process; a guarded link is left alone.
    ~LinkGuard();

    /// Guards this link from now on, and no other. It ends at the limit, for this process as if the
    /// peer had closed it. Errors: resource_unavailable if the guard's process is gone.
    Result<void> guard(TcpLink& link);
    /// Guards no link; to be called before the guarded one is destroyed, or it stays open.
    void release() noexcept;
    /// This process works. Neither waits, locks nor allocates.
    void alive() noexcept { beats_->fetch_add(1, std::memory_order_relaxed); }

    /// Of the guard's process.
    pid_t pid() const noexcept { return pid_; }

private:
    using Beats = std::atomic<std::uint32_t>;

    LinkGuard(pid_t pid, int channel, Beats* beats) : pid_(pid), channel_(channel), beats_(beats) {}
    void end() noexcept;

    pid_t pid_ = -1;
    int channel_ = -1;        // to the guard's process, which ends when it closes
    Beats* beats_ = nullptr;  // in memory that both processes see
};

}  // namespace metier::link
