#include "wire.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <initializer_list>
#include <vector>

namespace metier::virtual_iiwa {
namespace {

using Bytes = std::vector<std::byte>;

Bytes bytes(std::initializer_list<int> values) {
    Bytes result;
    for (const int value : values) {
        result.push_back(static_cast<std::byte>(value));
    }
    return result;
}

TEST(Wire, ReadsEightNumbersOfSinglePrecision) {
    auto command = bytes({0x42, 0xCC, 0, 0,    // 102
                          0x3F, 0x80, 0, 0,    // 1
                          0xBF, 0x00, 0, 0,    // -0.5
                          0x7F, 0xC0, 0, 0});  // not a number
    command.resize(32);
    const auto read = decodeCommand(command, Precision::single_precision);
    EXPECT_EQ(read.code, 102.0);
    EXPECT_EQ(read.arguments[0], 1.0);
    EXPECT_EQ(read.arguments[1], -0.5);
    EXPECT_TRUE(std::isnan(read.arguments[2]));
    EXPECT_EQ(read.arguments[6], 0.0);
}

TEST(Wire, ReadsEightNumbersOfDoublePrecision) {
    auto command = bytes({0x40, 0x59, 0x80, 0, 0, 0, 0, 0, 0x3F, 0xE0, 0, 0, 0, 0, 0, 0});
    command.resize(64);
    const auto read = decodeCommand(command, Precision::double_precision);
    EXPECT_EQ(read.code, 102.0);
    EXPECT_EQ(read.arguments[0], 0.5);
}

TEST(Wire, WritesThirtyEightNumbers) {
    StateNumbers state{};
    state[state_index::kStatus] = 1.0;
    state[state_index::kError] = -10.0;
    const auto single = encodeState(state, Precision::single_precision);
    ASSERT_EQ(single.size(), 152U);
    EXPECT_EQ(Bytes(single.begin(), single.begin() + 4), bytes({0x3F, 0x80, 0, 0}));
    EXPECT_EQ(Bytes(single.begin() + 136, single.begin() + 140), bytes({0xC1, 0x20, 0, 0}));
    const auto twice = encodeState(state, Precision::double_precision);
    ASSERT_EQ(twice.size(), 304U);
    EXPECT_EQ(Bytes(twice.begin(), twice.begin() + 8), bytes({0x3F, 0xF0, 0, 0, 0, 0, 0, 0}));
}

TEST(Wire, TurnsByAAboutZAndByCAboutX) {
    const auto pose = toPose({100.0, 0.0, -50.0, 0.5, 0.0, 0.0});
    EXPECT_EQ(pose.translation, Eigen::Vector3d(0.1, 0.0, -0.05));
    EXPECT_NEAR(pose.rotation.z(), std::sin(0.25), 1e-12);
    EXPECT_NEAR(toPose({0.0, 0.0, 0.0, 0.0, 0.0, 0.5}).rotation.x(), std::sin(0.25), 1e-12);
    EXPECT_THAT(toNumbers(toPose({1.0, 2.0, 3.0, 0.1, 0.2, 0.3})),
                ::testing::Pointwise(::testing::DoubleNear(1e-9),
                                     std::array{1.0, 2.0, 3.0, 0.1, 0.2, 0.3}));
}

}  // namespace
}  // namespace metier::virtual_iiwa
