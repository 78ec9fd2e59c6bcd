#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "metier/iiwa_driver/wire.hpp"

namespace {

using namespace metier::iiwa_driver;

void check(std::span<const std::byte> bytes, Precision precision) {
    const auto state = parseState(bytes, precision);
    if (!state) {
        if (toError(state.error()).message.empty()) {
            std::abort();
        }
        return;
    }
    for (const double value : state->position) {
        if (!std::isfinite(value)) {
            std::abort();
        }
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const auto bytes = std::as_bytes(std::span(data, size));
    for (const auto precision : {Precision::float32, Precision::float64}) {
        check(bytes, precision);
        if (bytes.size() > stateSize(precision)) {
            check(bytes.first(stateSize(precision)), precision);
        }
    }
    return 0;
}
