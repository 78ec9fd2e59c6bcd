#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>

namespace metier::benchmarks {

/// Something that serves for as long as it lives, and where.
struct Served {
    std::string url;
    // Only kept alive: a server of metier, or one of open62541 alone.
    std::shared_ptr<void> server;
};

/// A server in a process of its own, so that its CPU and its memory are its own, too.
///
/// Threading: one thread; made while the process has no other.
class ServerProcess {
public:
    /// \param serve runs in the new process. An exception there ends both processes.
    explicit ServerProcess(const std::function<Served()>& serve);
    /// Ends the process and waits for it.
    ~ServerProcess();
    ServerProcess(const ServerProcess&) = delete;
    ServerProcess& operator=(const ServerProcess&) = delete;

    const std::string& url() const noexcept { return url_; }
    /// Between the call of `serve` and its end.
    std::chrono::duration<double> startTime() const noexcept { return start_time_; }
    /// Resident memory that `serve` added [byte].
    double memory() const noexcept { return memory_; }
    /// CPU time of all its threads since it began.
    std::chrono::nanoseconds cpuTime() const;
    /// CPU time of the thread that used most: of a server that is busy, the one that owns it.
    std::chrono::nanoseconds busiestThreadTime() const;
    /// CPU time of the threads that yield to others: those of the policy SCHED_BATCH.
    std::chrono::nanoseconds yieldingThreadsTime() const;

private:
    pid_t pid_ = -1;
    int control_ = -1;  // closing it ends the child
    std::string url_;
    std::chrono::duration<double> start_time_{};
    double memory_ = 0;
};

}  // namespace metier::benchmarks
