#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "../tests/fake_peer.hpp"
#include "reads.hpp"
#include "rtde_session.hpp"

// Bytes as they come on port 30004, in any reads, with a cycle after each; and the same bytes as
// the payload of each package type, in both versions.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace metier::virtual_ur;
    RobotState state;
    ControlInputs control;
    RtdeShared shared{{3, 15, 8, 0}, 125.0, {state.inputs, control}, [](const auto&) {}, {}};
    FakePeer peer;
    const auto bytes = std::as_bytes(std::span(data, size));
    {
        RtdeSession session(shared, peer);
        bool open = true;
        metier::fuzz::inReads(bytes, [&](auto read) {
            open = open && session.receive(read);
            session.cycle(state);
        });
        RtdeSession framed(shared, peer);
        for (const char* types = "OIUSOVvPMUIS"; *types != 0; ++types) {
            ByteWriter package;
            package.put(static_cast<std::uint16_t>(size + 3))
                .put(static_cast<std::uint8_t>(*types))
                .bytes(bytes);
            (void)framed.receive(package.content());
            framed.cycle(state);
        }
    }
    for (const auto& sent : peer.sent) {
        ByteReader head(sent);
        if (head.get<std::uint16_t>() != sent.size()) {
            std::abort();
        }
    }
    if (!shared.claimed.empty()) {
        std::abort();
    }
    return 0;
}
