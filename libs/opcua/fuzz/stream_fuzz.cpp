// The header of every chunk that a connection brings, and text that is to be shown or is a NodeId.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <string_view>

#include "event_loop/message_counter.hpp"
#include "metier/opcua/node_id.hpp"
#include "metier/opcua/text.hpp"
#include "reads.hpp"

namespace {

using namespace metier::opcua;

std::span<const std::uint8_t> octets(std::span<const std::byte> bytes) {
    return {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()};
}

/// However the stream is cut, as many messages end in it.
void count(std::span<const std::byte> input) {
    if (input.empty()) {
        return;
    }
    MessageCounter counter;
    std::size_t messages = 0;
    metier::fuzz::inReads(input, [&](auto read) { messages += counter.feed(octets(read)); });
    if (messages != MessageCounter().feed(octets(input.subspan(1)))) {
        std::abort();
    }
}

void show(std::string_view text) {
    const auto shown = sanitise(text);
    if (sanitise(shown) != shown) {
        std::abort();
    }
    if (const auto id = NodeId::parse(text)) {
        const auto again = NodeId::parse(id->toString());
        // A text that cannot be shown as it is, is another id; every other is the same.
        const bool is_text = std::holds_alternative<std::string>(id->identifier());
        if (!again || (!is_text && *again != *id)) {
            std::abort();
        }
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    count(std::as_bytes(std::span(data, size)));
    show({reinterpret_cast<const char*>(data), size});
    return 0;
}
