#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <string>

#include "rdt.hpp"
#include "web.hpp"

// A datagram to the sensor, and the same bytes as a request for a web page.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace metier::virtual_netft;
    const auto bytes = std::as_bytes(std::span(data, size));
    if (parseRequest(bytes) && size != 8) {
        std::abort();
    }
    const std::string text(data, data + size);
    for (const std::string before :
         {"", "GET /", "GET /comm.cgi?comrdtrate=", "GET /setting.cgi?"}) {
        const auto answer = answerWeb(before + text + " HTTP/1.1\r\n\r\n", {});
        if (!answer.text.starts_with("HTTP/1.0 ") ||
            answer.changes.empty() == answer.text.starts_with("HTTP/1.0 302")) {
            std::abort();
        }
    }
    return 0;
}
