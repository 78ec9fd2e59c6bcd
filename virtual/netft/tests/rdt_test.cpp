#include "rdt.hpp"

#include <gtest/gtest.h>

#include <initializer_list>
#include <vector>

namespace metier::virtual_netft {
namespace {

std::vector<std::byte> bytes(std::initializer_list<int> values) {
    std::vector<std::byte> result;
    for (const int value : values) {
        result.push_back(static_cast<std::byte>(value));
    }
    return result;
}

TEST(Rdt, ReadsARequest) {
    const auto request = parseRequest(bytes({0x12, 0x34, 0x00, 0x02, 0x00, 0x01, 0x02, 0x03}));
    ASSERT_TRUE(request);
    EXPECT_EQ(request->command, Command::start_real_time);
    EXPECT_EQ(request->sample_count, 0x00010203U);
}

TEST(Rdt, IgnoresWhatIsNoRequest) {
    EXPECT_FALSE(parseRequest({}));
    EXPECT_FALSE(parseRequest(bytes({0x12, 0x34, 0, 2, 0, 0, 0})));
    EXPECT_FALSE(parseRequest(bytes({0x12, 0x34, 0, 2, 0, 0, 0, 0, 0})));
    EXPECT_FALSE(parseRequest(bytes({0x12, 0x35, 0, 2, 0, 0, 0, 0})));
    EXPECT_FALSE(parseRequest(bytes({0x12, 0x34, 0, 9, 0, 0, 0, 0})));
}

TEST(Rdt, WritesARecordBigEndian) {
    std::vector<std::byte> datagram;
    append(datagram, {1, 0x01020304, 0x80010000, {1'000'000, -1, 0, 0, 0, 0x7FFFFFFF}});
    EXPECT_EQ(datagram, bytes({0,    0,    0,    1,    1,    2,    3,    4,    0x80, 1,   0, 0, 0,
                               0x0F, 0x42, 0x40, 0xFF, 0xFF, 0xFF, 0xFF, 0,    0,    0,   0, 0, 0,
                               0,    0,    0,    0,    0,    0,    0x7F, 0xFF, 0xFF, 0xFF}));
}

}  // namespace
}  // namespace metier::virtual_netft
