// Takes any text for an HTTP answer and for a page of calibration.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "calibration.hpp"
#include "http_get.hpp"

namespace {

/// Takes the text for an answer that comes in parts of seven bytes.
void readFrom(std::string_view text) {
    using namespace metier;
    constexpr std::size_t kPart = 7;
    const auto receive = [&text](std::span<std::byte> bytes) -> Result<std::size_t> {
        const auto count = std::min({text.size(), bytes.size(), kPart});
        if (count == 0) {
            return fail(Errc::connection_lost, "end");
        }
        std::ranges::copy(std::as_bytes(std::span(text.substr(0, count))), bytes.begin());
        text.remove_prefix(count);
        return count;
    };
    if (const auto body = netft_driver::readHttpAnswer(receive);
        body && body->size() > netft_driver::kLargestPage) {
        __builtin_trap();
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace metier::netft_driver;
    const std::string text(data, data + size);
    static_cast<void>(parseCalibration(text, {"N", "Nm"}));
    const std::string whole = "<netft><cfgcpf>" + text + "</cfgcpf><cfgcpt>1</cfgcpt><scfgfu>" +
                              text + "</scfgfu></netft>";
    if (const auto calibration = parseCalibration(whole, {"N", "Nm"})) {
        if (!(calibration->force_per_count > 0.0)) {
            __builtin_trap();
        }
    }
    static_cast<void>(parseRate(text));
    const auto rate = parseRate("<netft><comrdtrate>" + text + "</comrdtrate></netft>");
    if (rate && *rate && !(**rate >= 1.0)) {
        __builtin_trap();
    }
    readFrom(text);
    readFrom("HTTP/1.0 200 OK\r\nContent-Length: " + text);
    return 0;
}
