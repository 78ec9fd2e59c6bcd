#include "rdt.hpp"

#include <gmock/gmock.h>

#include "wire.hpp"

namespace metier::netft_driver::testing {
namespace {

using ::testing::ElementsAre;

std::array<int, 8> request(RdtCommand command) {
    std::array<int, 8> numbers{};
    const auto bytes = rdtRequest(command);
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        numbers[i] = std::to_integer<int>(bytes[i]);
    }
    return numbers;
}

TEST(Rdt, RequestsAreBigEndianAndWithoutEnd) {
    EXPECT_THAT(request(RdtCommand::real_time), ElementsAre(0x12, 0x34, 0, 2, 0, 0, 0, 0));
    EXPECT_THAT(request(RdtCommand::stop), ElementsAre(0x12, 0x34, 0, 0, 0, 0, 0, 0));
    EXPECT_THAT(request(RdtCommand::bias), ElementsAre(0x12, 0x34, 0, 0x42, 0, 0, 0, 0));
}

TEST(Rdt, ARecordHasTwoSequencesAStatusAndSixCounts) {
    // sequence 258, sensor sequence 65536, saturation; 1, -1, 2^31-1, -2^31, 256, -256
    const std::array<int, 36> golden{0,    0, 1, 2, 0,    1,    0,    0,    0x80, 2,    0,    0,
                                     0,    0, 0, 1, 0xFF, 0xFF, 0xFF, 0xFF, 0x7F, 0xFF, 0xFF, 0xFF,
                                     0x80, 0, 0, 0, 0,    0,    1,    0,    0xFF, 0xFF, 0xFF, 0};
    Bytes bytes;
    for (const int number : golden) {
        bytes.push_back(static_cast<std::byte>(number));
    }
    const auto record = parseRecord(bytes);
    ASSERT_TRUE(record);
    EXPECT_EQ(record->sequence, 258U);
    EXPECT_EQ(record->sensor_sequence, 65536U);
    EXPECT_EQ(record->status, 0x80020000U);
    EXPECT_THAT(record->counts, ElementsAre(1, -1, 2147483647, -2147483648, 256, -256));
}

TEST(Rdt, RefusesAnyOtherSize) {
    for (const std::size_t size : {0U, 1U, 35U, 37U, 72U}) {
        EXPECT_FALSE(parseRecord(Bytes(size))) << size;
    }
}

TEST(Rdt, OneStatusIsAWarningAndEveryOtherAnError) {
    EXPECT_FALSE(isError(0));
    EXPECT_FALSE(isError(0x80010000U)) << "a warning";
    EXPECT_TRUE(isError(0x00010000U));
    EXPECT_TRUE(isError(0x80030000U));
    for (unsigned bit = 0; bit < 32; ++bit) {
        EXPECT_TRUE(isError(1U << bit)) << bit;
    }
}

TEST(Rdt, AStatusIsDescribedByItsCauses) {
    EXPECT_EQ(describeStatus(0), "healthy (status 00000000)");
    EXPECT_EQ(describeStatus(0x80020000U), "gauge saturation or A/D error (status 80020000)");
    EXPECT_EQ(describeStatus(0xC0000004U), "CPU or RAM, temperature (status C0000004)");
    EXPECT_EQ(describeStatus(0x80010000U), "monitor condition latched (status 80010000)");
    EXPECT_EQ(describeStatus(0x80000001U), "unknown cause (status 80000001)");
}

}  // namespace
}  // namespace metier::netft_driver::testing
