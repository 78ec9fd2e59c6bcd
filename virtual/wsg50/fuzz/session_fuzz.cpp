#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "reads.hpp"
#include "session.hpp"

// Bytes as they come over the wire, with time passing between the reads; and the same bytes as the
// payload of a sound frame, so that the commands behind the checksum are reached.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace metier::virtual_wsg50;
    const auto bytes = std::as_bytes(std::span(data, size));
    Session* open = nullptr;
    Gripper gripper({},
                    [&open](Command command, Status status) { open->finished(command, status); });
    Identity identity;
    Session session(gripper, identity, [](std::span<const std::byte> reply) {
        if (checksum(reply) != 0) {
            std::abort();
        }
    });
    open = &session;
    metier::fuzz::inReads(bytes, [&](auto read) { session.receive(read); });
    for (std::size_t at = 0; at < size; at += 11) {
        const auto part = bytes.subspan(at, std::min<std::size_t>(11, size - at));
        session.receive(encode(std::to_integer<std::uint8_t>(part[0]), part.subspan(1)));
        gripper.step(0.002, {.part = 0.03, .block = std::nullopt});
        session.step(std::chrono::milliseconds(2));
    }
    if (!(gripper.width() >= 0.0 && gripper.width() <= gripper.capability().stroke)) {
        std::abort();
    }
    return 0;
}
