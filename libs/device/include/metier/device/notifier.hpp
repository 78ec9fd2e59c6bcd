#pragma once

#include <semaphore.h>

#include <atomic>
#include <functional>
#include <thread>

namespace metier::device {

/// A thread that calls `handler` soon after each signal(): it does for a cycle thread what that
/// must not do itself, such as locking:
///
///     Notifier notifier([&core] { core.dispatch(); });
///     if (core.toTell()) { notifier.signal(); }  // cycle thread
///
/// Signals that come while the handler runs are handled together by one further call.
/// Threading: signal() from any thread; one thread creates and destroys it, never the handler.
class Notifier {
public:
    /// Starts the thread.
    /// \param handler runs on the notifier's own thread; must not throw, nor destroy the Notifier
    explicit Notifier(std::function<void()> handler);
    /// Handles pending signals, then ends the thread. Waits for a running handler.
    ~Notifier();
    Notifier(const Notifier&) = delete;
    Notifier& operator=(const Notifier&) = delete;

    /// Causes a call of `handler`, which begins after this call began. From any thread, also a
    /// cycle thread: neither locks nor allocates.
    void signal() noexcept;

private:
    /// Sleeps until a signal, clears it, calls the handler; the order makes sure that a signal
    /// during the handler is not lost.
    void run();

    std::function<void()> handler_;
    std::atomic<bool> pending_{false};
    std::atomic<bool> ending_{false};
    sem_t wake_{};  // std::counting_semaphore of g++ 12.2 can miss a release (GCC PR 104928)
    std::jthread thread_;
};

}  // namespace metier::device
