// Takes any text for an HTTP answer and for a page of calibration.
#include <cstddef>
#include <cstdint>
#include <string>

#include "metier/netft_driver/calibration.hpp"
#include "metier/netft_driver/http_get.hpp"

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
    static_cast<void>(parseHttpAnswer(text));
    static_cast<void>(parseHttpAnswer("HTTP/1.0 200 OK\r\nContent-Length: " + text));
    return 0;
}
