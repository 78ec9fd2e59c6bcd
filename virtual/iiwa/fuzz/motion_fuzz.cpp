#include <cmath>
#include <cstdlib>

#include "commands.hpp"

// Commands of eight numbers, with some cycles of the arm between them.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace metier::virtual_iiwa;
    auto own_cabinet = cabinet();
    RobotApplication application(own_cabinet);
    const auto input = std::span(data, size);
    const auto length = commandSize(Precision::single_precision);
    for (std::size_t at = 0; at + length <= size; at += length) {
        application.execute(commandOf(input.subspan(at, length), Precision::single_precision));
        const int cycles = data[at + 2] % 8 == 0 ? 20 : 1;
        for (int cycle = 0; cycle < cycles; ++cycle) {
            application.step(own_cabinet.arm.step());
        }
    }
    for (const double joint : own_cabinet.arm.position()) {
        if (!std::isfinite(joint)) {
            std::abort();
        }
    }
    encodeState(application.state(), Precision::double_precision);
    return 0;
}
