#include "metier/virtual_controller/peer_lines.hpp"

namespace metier::virtual_controller {

void PeerLines::add(TcpPeer& peer, std::span<const std::byte> bytes,
                    const std::function<void(std::string_view)>& take) {
    auto& part = parts_[&peer];
    part.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    std::size_t begin = 0;
    for (auto end = part.find('\n'); end != std::string::npos; end = part.find('\n', begin)) {
        if (end - begin > longest_) {
            break;
        }
        take(std::string_view(part).substr(begin, end - begin));
        begin = end + 1;
    }
    part.erase(0, begin);
    if (part.size() > longest_) {
        peer.reset();
    }
}

}  // namespace metier::virtual_controller
