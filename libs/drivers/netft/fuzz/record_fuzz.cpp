// Gives a stream any datagrams: the first byte of each is its length.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "record_stream.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace metier;
    netft_driver::RecordStream stream({1e-6, 1e-6});
    auto input = std::as_bytes(std::span(data, size));
    while (!input.empty()) {
        const auto length = std::min(std::to_integer<std::size_t>(input[0]), input.size() - 1);
        if (const auto sample = stream.take(input.subspan(1, length), SteadyTime())) {
            static_cast<void>(netft_driver::describeStatus(stream.status()));
        }
        input = input.subspan(1 + length);
    }
    return 0;
}
