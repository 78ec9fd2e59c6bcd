#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <string_view>

#include "metier/virtual_netft/rdt.hpp"
#include "metier/virtual_netft/web.hpp"

// A datagram to the sensor, and the same bytes as a request for a web page.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace metier::virtual_netft;
    const auto bytes = std::as_bytes(std::span(data, size));
    if (parseRequest(bytes) && size != 8) {
        std::abort();
    }
    std::string text(size, '\0');
    for (std::size_t i = 0; i < size; ++i) {
        text[i] = static_cast<char>(data[i]);
    }
    if (!answerWeb(text, "product", {}).starts_with("HTTP/1.0 ")) {
        std::abort();
    }
    return 0;
}
