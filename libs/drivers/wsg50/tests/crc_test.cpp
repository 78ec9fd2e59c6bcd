#include "crc.hpp"

#include <gtest/gtest.h>

#include <string>

#include "wire.hpp"

namespace metier::wsg50_driver::testing {
namespace {

struct Vector {
    int id;
    Bytes payload;
    int first;  // byte of the checksum, as it is sent
    int second;
};

class Crc : public ::testing::TestWithParam<Vector> {};

TEST_P(Crc, IsWhatTheGripperSends) {
    const auto& [id, payload, first, second] = GetParam();
    const auto head =
        bytes({0xAA, 0xAA, 0xAA, id}) + u16(static_cast<unsigned>(payload.size())) + payload;
    const auto check = bytes({first, second});
    EXPECT_EQ(u16(crc(head)), check);
    EXPECT_EQ(crc(head + check), 0) << "over a whole frame";
}

// Public vectors of ThomasKuehne/wsg50 @ cd67b66.
INSTANTIATE_TEST_SUITE_P(
    PublicVectors, Crc,
    ::testing::Values(Vector{0x24, text("ack"), 0xDC, 0xB9}, Vector{0x36, {}, 0x17, 0x93},
                      Vector{0x07, {}, 0x35, 0x4C}, Vector{0x23, {}, 0xAC, 0x1C},
                      Vector{0x31, {}, 0x68, 0xA5}, Vector{0x33, {}, 0x2C, 0x70},
                      Vector{0x35, {}, 0xF1, 0x2C}, Vector{0x50, {}, 0xDB, 0x87},
                      Vector{0x53, {}, 0x3D, 0x38}, Vector{0x46, {}, 0x86, 0xB7},
                      Vector{0x20, bytes({2}), 0xCD, 0xA3}, Vector{0x20, bytes({0}), 0x8F, 0x83},
                      Vector{0x22, {}, 0x0E, 0x76}, Vector{0x06, text("abc"), 0xCA, 0x44},
                      Vector{0x37, bytes({1}), 0x04, 0x8D}, Vector{0x42, bytes({1}), 0x63, 0x99},
                      Vector{0x41, bytes({0x01, 0x0E, 0x4E}), 0x15, 0xB9},
                      Vector{0x43, bytes({0x01, 0x34, 0x12}), 0x85, 0xF3},
                      Vector{0x25, f32(12.0F) + f32(34.0F), 0xA7, 0xF1},
                      Vector{0x21, bytes({2}) + f32(34.0F) + f32(56.0F), 0x95, 0x56}));

TEST(CrcOfParts, OfThePreambleAloneIsTheKnownValue) {
    EXPECT_EQ(crc(bytes({0xAA, 0xAA, 0xAA})), 0x50F5);
}

}  // namespace
}  // namespace metier::wsg50_driver::testing
