#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "dashboard.hpp"
#include "reads.hpp"

using namespace metier::ur_driver;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const auto bytes = std::as_bytes(std::span(data, size));
    StreamBuffer buffer(std::max<std::size_t>(2 * size, 16));
    metier::fuzz::inReads(bytes, [&](auto read) {
        std::copy(read.begin(), read.end(), buffer.space().begin());
        buffer.filled(read.size());
        for (auto line = dashboard::takeLine(buffer); line && *line;
             line = dashboard::takeLine(buffer)) {
            (void)dashboard::parseFlag(**line);
        }
    });
    return 0;
}
