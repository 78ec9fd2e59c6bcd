#include "metier/virtual_controller/link_faults.hpp"

namespace metier::virtual_controller {

namespace {

constexpr std::byte kChange{0x55};

/// 1/2, 1/4, 3/4, 1/8, 5/8, 3/8, 7/8, 1/16, ...: the bits of 1, 2, 3, ... behind the point.
double share(std::uint32_t number) noexcept {
    double sum = 0.0;
    for (double digit = 0.5; number != 0; digit /= 2.0, number /= 2) {
        sum += number % 2 == 0 ? 0.0 : digit;
    }
    return sum;
}

}  // namespace

void LinkFaults::spoil(std::span<std::byte> packet) noexcept {
    auto left = garble.load();
    if (packet.empty() || left == 0 || !garble.compare_exchange_strong(left, left - 1)) {
        return;
    }
    const auto turn = spoilt_++;
    const double place = turn % 2 == 0 ? share(turn / 2 + 1) : 0.0;
    packet[static_cast<std::size_t>(place * static_cast<double>(packet.size()))] ^= kChange;
}

}  // namespace metier::virtual_controller
