#pragma once

#include <atomic>
#include <cstdint>

namespace metier::server {

/// A number that only grows. Threads: any; nothing waits.
class Counter {
public:
    void add(std::uint64_t count = 1) noexcept {
        count_.fetch_add(count, std::memory_order_relaxed);
    }
    std::uint64_t value() const noexcept { return count_.load(std::memory_order_relaxed); }

private:
    std::atomic<std::uint64_t> count_{0};
};

}  // namespace metier::server
