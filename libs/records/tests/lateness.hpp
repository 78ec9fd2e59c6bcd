#pragma once

#include <fcntl.h>
#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <mutex>
#include <thread>

#include "metier/base/clock.hpp"

namespace metier::records {

/// Delay with which a thread of the writer's priority wakes up on this machine now, or has a byte
/// on the disk: nothing that the writer does can be more punctual.
class Lateness {
public:
    /// \param folder in which a file of its own is written, on the disk of the records
    explicit Lateness(const std::filesystem::path& folder) {
        std::filesystem::create_directories(folder);
        file_ = ::open((folder / "lateness").c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
        thread_ = std::jthread([this](const std::stop_token& stop) { measure(stop); });
    }
    ~Lateness() {
        thread_ = {};
        ::close(file_);
    }
    Lateness(const Lateness&) = delete;
    Lateness& operator=(const Lateness&) = delete;

    /// Largest delay so far.
    std::chrono::nanoseconds worst() const { return worst_; }

private:
    void measure(const std::stop_token& stop) {
        const sched_param no_priority{};
        static_cast<void>(sched_setscheduler(0, SCHED_BATCH, &no_priority));
        std::mutex mutex;
        std::condition_variable_any nobody;
        std::unique_lock lock(mutex);
        int rounds = 0;
        while (!stop.stop_requested()) {
            const auto due = std::chrono::steady_clock::now() + std::chrono::milliseconds(5);
            nobody.wait_until(lock, stop, due, [] { return false; });
            note(due);
            if (++rounds % kRoundsBetweenSyncs == 0) {
                const auto begun = std::chrono::steady_clock::now();
                static_cast<void>(::pwrite(file_, "x", 1, rounds));
                static_cast<void>(::fdatasync(file_));
                note(begun);
            }
        }
    }
    /// \param since when what is over now should have been
    void note(SteadyTime since) {
        const std::chrono::nanoseconds late = std::chrono::steady_clock::now() - since;
        worst_ = std::max(worst_.load(), late);
    }

    static constexpr int kRoundsBetweenSyncs = 40;

    std::atomic<std::chrono::nanoseconds> worst_{};
    int file_ = -1;
    std::jthread thread_;  // last
};

}  // namespace metier::records
