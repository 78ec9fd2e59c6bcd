#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace metier::opcua {

/// Data that a peer has sent and the stack has not got yet, in pieces that end with a chunk at the
/// latest: so the loop can serve other connections between two messages that came together.
///
/// Only the size in each chunk's header is read (OPC 10000-6, 6.7.2.2); it is never encrypted.
class Inbox {
public:
    void push(std::span<const std::uint8_t> bytes);
    bool empty() const { return taken_ == bytes_.size(); }
    /// The next chunk, or what there is of it; all there is once something was no chunk. It may be
    /// changed, and is valid until the next push() or done(). Must not be empty.
    std::span<std::uint8_t> take();
    /// Frees what was taken.
    void done();

private:
    static constexpr std::size_t kHeader = 8;

    std::size_t sizeOfNext();
    std::size_t bodySize() const;

    std::vector<std::uint8_t> bytes_;
    std::size_t taken_ = 0;
    std::array<std::uint8_t, kHeader> header_{};
    std::size_t header_filled_ = 0;
    std::size_t body_left_ = 0;
};

}  // namespace metier::opcua
