#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>

#include "metier/virtual_controller/tcp_server.hpp"

namespace metier::virtual_controller {

/// Cuts the bytes from the peers of a port into lines.
///
/// Threading: the thread of its server.
class PeerLines {
public:
    /// \param longest longest line [byte]; a peer that sends a longer one is reset
    explicit PeerLines(std::size_t longest = 4096) : longest_(longest) {}

    /// Calls `take` for each complete line, without its line feed.
    /// A carriage return before the line feed stays part of the line. Lines that were complete
    /// before a line that is too long are still handed over. `take` must not destroy this, nor call
    /// add().
    /// \param take valid during the call; the line is a view that ends with it
    void add(TcpPeer& peer, std::span<const std::byte> bytes,
             const std::function<void(std::string_view)>& take);
    /// Drops the incomplete line of a peer; call it from on_closed.
    void forget(const TcpPeer& peer) { parts_.erase(&peer); }

private:
    std::size_t longest_;
    std::map<const TcpPeer*, std::string> parts_;  // bytes since the last line feed
};

}  // namespace metier::virtual_controller
