#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

namespace metier::ur_driver {

/// Bytes of a stream that were received but not yet understood.
///
/// Threading: one thread. Allocates when it is made and never again.
class StreamBuffer {
public:
    /// \param capacity at least twice the longest thing that is looked for in the stream
    explicit StreamBuffer(std::size_t capacity) : bytes_(capacity) {}

    /// Space for the next bytes; empty only if nothing was consumed from a full buffer.
    std::span<std::byte> space() noexcept {
        if (begin_ > 0 && bytes_.size() - end_ < bytes_.size() / 2) {
            std::copy(bytes_.begin() + static_cast<std::ptrdiff_t>(begin_),
                      bytes_.begin() + static_cast<std::ptrdiff_t>(end_), bytes_.begin());
            end_ -= begin_;
            begin_ = 0;
        }
        return std::span(bytes_).subspan(end_);
    }
    /// Notes that `count` bytes of space() were filled.
    void filled(std::size_t count) noexcept { end_ += std::min(count, bytes_.size() - end_); }
    /// Received bytes that were not consumed; valid until space() is called.
    std::span<const std::byte> received() const noexcept {
        return std::span(bytes_).subspan(begin_, end_ - begin_);
    }
    void consume(std::size_t count) noexcept { begin_ += std::min(count, end_ - begin_); }

private:
    std::vector<std::byte> bytes_;
    std::size_t begin_ = 0;
    std::size_t end_ = 0;
};

}  // namespace metier::ur_driver
