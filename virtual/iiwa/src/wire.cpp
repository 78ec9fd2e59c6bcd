#include "wire.hpp"

#include <algorithm>

#include "metier/base/numbers.hpp"
#include "metier/motion/frame.hpp"
#include "metier/virtual_controller/wire_bytes.hpp"

namespace metier::virtual_iiwa {

namespace {

constexpr double kMillimetre = 1e-3;

}  // namespace

std::size_t commandSize(Precision precision) noexcept {
    return 8 * (precision == Precision::single_precision ? sizeof(float) : sizeof(double));
}

Command decodeCommand(std::span<const std::byte> bytes, Precision precision) noexcept {
    virtual_controller::ByteReader reader(bytes);
    const auto next = [&] {
        return precision == Precision::single_precision ? double{reader.get<float>()}
                                                        : reader.get<double>();
    };
    Command command;
    command.code = next();
    std::ranges::generate(command.arguments, next);
    return command;
}

std::vector<std::byte> encodeState(const StateNumbers& state, Precision precision) {
    virtual_controller::ByteWriter bytes;
    for (const double number : state) {
        if (precision == Precision::single_precision) {
            bytes.put(static_cast<float>(number));
        } else {
            bytes.put(number);
        }
    }
    return bytes.content();
}

motion::Pose toPose(const std::array<double, 6>& xyzabc) {
    return motion::toPose({xyzabc[0] * kMillimetre, xyzabc[1] * kMillimetre,
                           xyzabc[2] * kMillimetre, xyzabc[5], xyzabc[4], xyzabc[3]});
}

std::array<double, 6> toNumbers(const motion::Pose& pose) {
    const auto frame = motion::toFrame(pose);
    return {frame.x / kMillimetre,
            frame.y / kMillimetre,
            frame.z / kMillimetre,
            frame.c,
            frame.b,
            frame.a};
}

}  // namespace metier::virtual_iiwa
