#include "commands.hpp"

// Commands of eight numbers in either precision to a cabinet whose arm stands still.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace metier::virtual_iiwa;
    if (size == 0) {
        return 0;
    }
    auto own_cabinet = cabinet();
    RobotApplication application(own_cabinet);
    const auto precision =
        data[0] % 4 == 0 ? Precision::double_precision : Precision::single_precision;
    const auto input = std::span(data, size);
    const auto length = commandSize(precision);
    for (std::size_t at = 0; at + length <= size; at += length) {
        application.execute(commandOf(input.subspan(at, length), precision));
        encodeState(application.state(), precision);
    }
    return 0;
}
