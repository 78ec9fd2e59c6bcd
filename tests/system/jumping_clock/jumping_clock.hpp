#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace metier::system_tests {

/// The clock of another process, which can be set to any time while the process runs.
///
/// Threading: one thread.
class JumpingClock {
public:
    /// Right at first. Throws if it cannot be shared.
    JumpingClock();
    ~JumpingClock();
    JumpingClock(const JumpingClock&) = delete;
    JumpingClock& operator=(const JumpingClock&) = delete;

    /// Why processes cannot have such a clock in this build; empty: they can.
    static std::string obstacle();
    /// Sets how far it is ahead of the right time.
    void set(std::chrono::nanoseconds ahead);
    /// A command that starts a process with this clock.
    std::vector<std::string> of(std::vector<std::string> command) const;

private:
    std::filesystem::path file_;
    std::atomic<std::int64_t>* offset_;  // [ns], mapped from the file
};

}  // namespace metier::system_tests
