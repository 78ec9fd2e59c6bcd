#include "frame.hpp"

#include <gmock/gmock.h>

#include <algorithm>

#include "messages.hpp"
#include "wire.hpp"

namespace metier::wsg50_driver::testing {
namespace {

Bytes toBytes(std::span<const std::byte> span) {
    return {span.begin(), span.end()};
}

/// Gives bytes to a reader and collects the ids of what it finds.
class Reading {
public:
    std::vector<int> give(const Bytes& given) {
        std::vector<int> ids;
        for (std::size_t taken = 0; taken < given.size();) {
            const auto space = reader.space();
            const auto count = std::min(space.size(), given.size() - taken);
            std::copy_n(given.begin() + static_cast<std::ptrdiff_t>(taken), count, space.begin());
            reader.received(count);
            taken += count;
            while (const auto found = reader.next()) {
                ids.push_back(found->id);
                payload = toBytes(found->payload);
            }
        }
        return ids;
    }

    FrameReader reader;
    Bytes payload;
};

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(Command, IsTheFrameThatTheGripperKnows) {
    EXPECT_EQ(toBytes(acknowledgeCommand().bytes()),
              bytes({0xAA, 0xAA, 0xAA, 0x24, 3, 0, 'a', 'c', 'k', 0xDC, 0xB9}));
    EXPECT_EQ(toBytes(Command(CommandId::disconnect).bytes()),
              bytes({0xAA, 0xAA, 0xAA, 0x07, 0, 0, 0x35, 0x4C}));
}

TEST(FrameReader, FindsFramesOneAfterTheOther) {
    Reading reading;
    EXPECT_THAT(reading.give(frame(0x40, bytes({0, 0, 1})) + frame(0x43, {})),
                ElementsAre(0x40, 0x43));
    EXPECT_THAT(reading.payload, IsEmpty());
}

TEST(FrameReader, WaitsForTheRestOfAFrame) {
    const auto whole = frame(0x43, bytes({0, 0, 1, 2, 3, 4}));
    Reading reading;
    for (std::size_t i = 0; i + 1 < whole.size(); ++i) {
        EXPECT_THAT(reading.give({whole[i]}), IsEmpty()) << "byte " << i;
    }
    EXPECT_THAT(reading.give({whole.back()}), ElementsAre(0x43));
    EXPECT_EQ(reading.payload, bytes({0, 0, 1, 2, 3, 4}));
}

TEST(FrameReader, SkipsAFrameWithAWrongChecksumAndFindsTheNext) {
    auto broken = frame(0x43, bytes({0, 0}));
    broken[7] ^= std::byte{1};
    Reading reading;
    EXPECT_THAT(reading.give(broken + frame(0x45, {})), ElementsAre(0x45));
}

TEST(FrameReader, FindsAFrameBehindOneWithAWrongLength) {
    auto broken = frame(0x43, bytes({0, 0}));
    broken[4] = std::byte{40};
    Reading reading;
    EXPECT_THAT(reading.give(broken + frame(0x45, bytes({0, 0})) + frame(0x40, Bytes(40))),
                ElementsAre(0x45, 0x40));
}

TEST(FrameReader, SkipsWhatIsNoFrame) {
    Reading reading;
    EXPECT_THAT(reading.give(bytes({1, 0xAA, 2, 0xAA, 0xAA, 0xAA, 0xAA}) + frame(0x45, {}) +
                             frame(0x40, Bytes(80))),
                ElementsAre(0x45, 0x40));
}

TEST(FrameReader, DoesNotWaitForAPayloadThatNoGripperSends) {
    Reading reading;
    EXPECT_THAT(reading.give(bytes({0xAA, 0xAA, 0xAA, 0x40, 0xFF, 0xFF}) + frame(0x45, {})),
                ElementsAre(0x45));
}

TEST(FrameReader, TakesTheLongestPayloadAndAnyNumberOfFrames) {
    const auto longest = frame(0x63, Bytes(FrameReader::kLargestPayload));
    Reading reading;
    std::size_t found = 0;
    for (int i = 0; i < 100; ++i) {
        found += reading.give(longest).size();
    }
    EXPECT_EQ(found, 100U);
}

}  // namespace
}  // namespace metier::wsg50_driver::testing
