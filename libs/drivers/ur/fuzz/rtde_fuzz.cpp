#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "reads.hpp"
#include "rtde.hpp"

using namespace metier::ur_driver;

namespace {

void parseAll(std::span<const std::byte> payload) {
    (void)rtde::parseAccepted(payload);
    (void)rtde::parseControllerVersion(payload);
    (void)rtde::parseTextMessage(payload);
    if (const auto reply = rtde::parseRecipeReply(payload)) {
        (void)rtde::OutputRecipe(24).take(*reply);
        (void)rtde::checkSetpointReply(*reply, 24);
    }
    (void)rtde::OutputRecipe(24).decode(payload);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const auto bytes = std::as_bytes(std::span(data, size));
    parseAll(bytes);
    StreamBuffer buffer(256);
    metier::fuzz::inReads(bytes, [&](auto read) {
        const auto space = buffer.space();  // a full buffer takes no more, as in a session
        const auto count = std::min(space.size(), read.size());
        std::copy_n(read.begin(), count, space.begin());
        buffer.filled(count);
        for (auto package = rtde::firstPackage(buffer); package && *package;
             package = rtde::firstPackage(buffer)) {
            parseAll((*package)->payload);
            buffer.consume(rtde::kHeaderSize + (*package)->payload.size());
        }
    });
    return 0;
}
