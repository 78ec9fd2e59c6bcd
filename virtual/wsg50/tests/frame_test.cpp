#include "frame.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <initializer_list>
#include <vector>

namespace metier::virtual_wsg50 {
namespace {

using Bytes = std::vector<std::byte>;

Bytes bytes(std::initializer_list<int> values) {
    Bytes result;
    for (const int value : values) {
        result.push_back(static_cast<std::byte>(value));
    }
    return result;
}

void append(Bytes& to, float value) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    for (unsigned shift = 0; shift < 32; shift += 8) {
        to.push_back(static_cast<std::byte>(bits >> shift & 0xFFU));
    }
}

Bytes withFloats(Bytes start, std::initializer_list<float> values) {
    for (const float value : values) {
        append(start, value);
    }
    return start;
}

struct Vector {
    std::uint8_t id;
    Bytes payload;
    Bytes checksum;
};

// Frames whose checksum is known from ThomasKuehne/wsg50 @ cd67b66, its packet tests.
std::vector<Vector> vectors() {
    return {
        {0x24, bytes({'a', 'c', 'k'}), bytes({0xDC, 0xB9})},
        {0x36, {}, bytes({0x17, 0x93})},
        {0x07, {}, bytes({0x35, 0x4C})},
        {0x23, {}, bytes({0xAC, 0x1C})},
        {0x31, {}, bytes({0x68, 0xA5})},
        {0x33, {}, bytes({0x2C, 0x70})},
        {0x35, {}, bytes({0xF1, 0x2C})},
        {0x50, {}, bytes({0xDB, 0x87})},
        {0x53, {}, bytes({0x3D, 0x38})},
        {0x46, {}, bytes({0x86, 0xB7})},
        {0x20, bytes({2}), bytes({0xCD, 0xA3})},
        {0x20, bytes({0}), bytes({0x8F, 0x83})},
        {0x22, {}, bytes({0x0E, 0x76})},
        {0x06, bytes({'a', 'b', 'c'}), bytes({0xCA, 0x44})},
        {0x37, bytes({1}), bytes({0x04, 0x8D})},
        {0x42, bytes({1}), bytes({0x63, 0x99})},
        {0x41, bytes({1, 0x0E, 0x4E}), bytes({0x15, 0xB9})},
        {0x43, bytes({1, 0x34, 0x12}), bytes({0x85, 0xF3})},
        {0x25, withFloats({}, {12.0F, 34.0F}), bytes({0xA7, 0xF1})},
        {0x21, withFloats(bytes({2}), {34.0F, 56.0F}), bytes({0x95, 0x56})},
    };
}

TEST(Frame, HasTheChecksumOfEveryKnownFrame) {
    for (const auto& known : vectors()) {
        const auto frame = encode(known.id, known.payload);
        EXPECT_EQ(Bytes(frame.end() - 2, frame.end()), known.checksum) << int{known.id};
        EXPECT_EQ(checksum(frame), 0);
    }
}

TEST(Frame, HasTheKnownChecksumOfThePreamble) {
    EXPECT_EQ(checksum(bytes({0xAA, 0xAA, 0xAA})), 0x50F5);
}

TEST(FrameReader, ReadsEveryKnownFrameByteByByte) {
    for (const auto& known : vectors()) {
        FrameReader reader;
        const auto sent = encode(known.id, known.payload);
        for (const std::byte byte : sent) {
            EXPECT_FALSE(reader.next());
            reader.feed({&byte, 1});
        }
        const auto frame = reader.next();
        ASSERT_TRUE(frame);
        EXPECT_EQ(frame->id, known.id);
        EXPECT_EQ(frame->payload, known.payload);
        EXPECT_TRUE(frame->intact);
    }
}

TEST(FrameReader, FindsFramesBehindRubbishAndSeveralAtOnce) {
    FrameReader reader;
    reader.feed(bytes({0xAA, 0xAA, 7, 0xAA}));
    reader.feed(bytes({0xAA, 0xAA}));
    const auto first = encode(0x22, {});
    reader.feed(std::span(first).subspan(3));
    reader.feed(encode(0x50, {}));
    EXPECT_EQ(reader.next()->id, 0x22);
    EXPECT_EQ(reader.next()->id, 0x50);
    EXPECT_FALSE(reader.next());
}

TEST(FrameReader, TellsThatAFrameWasChangedOnItsWay) {
    FrameReader reader;
    auto frame = encode(0x06, bytes({1, 2, 3}));
    frame[7] ^= std::byte{0x10};
    reader.feed(frame);
    EXPECT_FALSE(reader.next()->intact);
}

}  // namespace
}  // namespace metier::virtual_wsg50
