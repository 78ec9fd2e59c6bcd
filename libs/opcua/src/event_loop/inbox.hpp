#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "chunk_reader.hpp"

namespace metier::opcua {

/// Data that a peer has sent and the stack has not got yet, in pieces that end with a chunk at the
/// latest: so the loop can serve other connections between two messages that came together.
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
    std::vector<std::uint8_t> bytes_;
    std::size_t taken_ = 0;
    ChunkReader chunks_;
};

}  // namespace metier::opcua
