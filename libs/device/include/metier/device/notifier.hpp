#pragma once

#include <semaphore.h>

#include <atomic>
#include <functional>
#include <thread>

namespace metier::device {

/// A thread that does what a cycle thread may not: it calls `handler` soon after each signal().
///
/// Signals that come while the handler runs are handled together by one further call.
class Notifier {
public:
    /// \param handler runs on the notifier's own thread; must not throw
    explicit Notifier(std::function<void()> handler);
    /// Handles what was signalled, then ends the thread.
    ~Notifier();
    Notifier(const Notifier&) = delete;
    Notifier& operator=(const Notifier&) = delete;

    /// Any thread, a cycle thread too: neither locks nor allocates.
    void signal() noexcept;

private:
    void run();

    std::function<void()> handler_;
    std::atomic<bool> pending_{false};
    std::atomic<bool> ending_{false};
    sem_t wake_{};  // std::counting_semaphore of g++ 12.2 can miss a release (GCC PR 104928)
    std::jthread thread_;
};

}  // namespace metier::device
