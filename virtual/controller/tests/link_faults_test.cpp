#include "metier/virtual_controller/link_faults.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <vector>

namespace metier::virtual_controller {
namespace {

using ::testing::ElementsAre;

/// Which byte of a packet of zeros is changed; 99: none.
std::size_t placeChangedBy(LinkFaults& faults, std::span<std::byte> packet) {
    faults.spoil(packet);
    const auto changed =
        std::find_if(packet.begin(), packet.end(), [](auto byte) { return byte != std::byte{}; });
    const auto place = changed == packet.end() ? 99 : changed - packet.begin();
    std::fill(packet.begin(), packet.end(), std::byte{});
    return static_cast<std::size_t>(place);
}

TEST(LinkFaults, GarbleTheBeginAndTheMiddleInTurnsAndThenEverFiner) {
    LinkFaults faults;
    faults.garble = 9;
    std::array<std::byte, 16> packet{};
    std::vector<std::size_t> places;
    for (int i = 0; i < 10; ++i) {
        places.push_back(placeChangedBy(faults, packet));
    }
    EXPECT_THAT(places, ElementsAre(8, 0, 4, 0, 12, 0, 2, 0, 10, 99));
}

TEST(LinkFaults, GarbleEveryByteOfALongPacketInTheEnd) {
    LinkFaults faults;
    faults.garble = 1000;
    std::vector<std::byte> packet(250);
    std::vector<bool> seen(packet.size());
    for (int i = 0; i < 1000; ++i) {
        seen.at(placeChangedBy(faults, packet)) = true;
    }
    EXPECT_EQ(std::count(seen.begin(), seen.end(), false), 0);
}

TEST(LinkFaults, GarbleNothingOfAnEmptyPacket) {
    LinkFaults faults;
    faults.garble = 1;
    faults.spoil({});
    EXPECT_EQ(faults.garble, 1U);
}

}  // namespace
}  // namespace metier::virtual_controller
