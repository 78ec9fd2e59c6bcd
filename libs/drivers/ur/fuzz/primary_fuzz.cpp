#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "primary.hpp"
#include "reads.hpp"

using namespace metier::ur_driver;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const auto bytes = std::as_bytes(std::span(data, size));
    if (const auto package = primary::parse(bytes); package && package->report) {
        (void)package->report->toText();
    }
    StreamBuffer buffer(std::max<std::size_t>(2 * size, 16));
    metier::fuzz::inReads(bytes, [&](auto read) {
        std::copy(read.begin(), read.end(), buffer.space().begin());
        buffer.filled(read.size());
        for (auto length = primary::firstPackageSize(buffer); length && *length;
             length = primary::firstPackageSize(buffer)) {
            (void)primary::parse(buffer.received().first(**length));
            buffer.consume(**length);
        }
    });
    return 0;
}
