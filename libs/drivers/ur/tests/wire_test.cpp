#include "wire.hpp"

#include <gmock/gmock.h>

#include "stream_buffer.hpp"
#include "wire_bytes.hpp"

namespace metier::ur_driver {
namespace {

TEST(ByteReader, ReadsBigEndianValues) {
    const auto bytes = fromHex("01 02 03 FF FF FF FE 3F F8 00 00 00 00 00 00 41 42");
    ByteReader reader(bytes);
    EXPECT_EQ(reader.uint8(), 1);
    EXPECT_EQ(reader.number<std::uint16_t>(), 0x0203);
    EXPECT_EQ(reader.number<std::int32_t>(), -2);
    EXPECT_EQ(reader.float64(), 1.5);
    EXPECT_EQ(reader.restAsText(), "AB");
    EXPECT_TRUE(reader.ok());
    EXPECT_EQ(reader.remaining(), 0U);
}

TEST(ByteReader, RemembersThatSomethingWasMissing) {
    const auto bytes = fromHex("01 02 03");
    ByteReader reader(bytes);
    EXPECT_EQ(reader.number<std::uint32_t>(), 0U);
    EXPECT_FALSE(reader.ok());
    EXPECT_EQ(reader.uint8(), 0) << "nothing is read after that";
    EXPECT_EQ(reader.text(5), "");
    EXPECT_FALSE(reader.ok());
}

TEST(ByteWriter, WritesWhatTheReaderReads) {
    std::vector<std::byte> bytes;
    ByteWriter writer(std::back_inserter(bytes));
    writer.number(std::int32_t{-3});
    writer.float64(-0.25);
    writer.number(std::uint16_t{65535});
    writer.text("x");
    EXPECT_EQ(bytes, fromHex("FF FF FF FD BF D0 00 00 00 00 00 00 FF FF 78"));
    ByteReader reader(bytes);
    EXPECT_EQ(reader.number<std::int32_t>(), -3);
    EXPECT_EQ(reader.float64(), -0.25);
    EXPECT_EQ(reader.number<std::uint16_t>(), 65535);
}

TEST(Printable, IsOneLineOfLimitedLength) {
    EXPECT_EQ(printable("a\nb\tc\x80  "), "a b c");
    EXPECT_EQ(printable(""), "");
    EXPECT_EQ(printable("\n\r"), "");
    EXPECT_EQ(printable(std::string(1000, 'y')).size(), 300U);
}

TEST(StreamBuffer, NeverRunsOutOfSpaceForThingsOfHalfItsCapacity) {
    StreamBuffer buffer(16);
    for (int i = 0; i < 100; ++i) {
        const auto space = buffer.space();
        ASSERT_GE(space.size(), 8U);
        space[0] = static_cast<std::byte>(i);
        buffer.filled(8);
        ASSERT_EQ(buffer.received().size(), 8U);
        ASSERT_EQ(buffer.received()[0], static_cast<std::byte>(i));
        buffer.consume(8);
    }
}

TEST(StreamBuffer, KeepsWhatWasNotConsumed) {
    StreamBuffer buffer(8);
    for (int i = 0; i < 6; ++i) {
        buffer.space()[static_cast<std::size_t>(0)] = static_cast<std::byte>(i);
        buffer.filled(1);
    }
    buffer.consume(4);
    EXPECT_GE(buffer.space().size(), 4U);
    ASSERT_EQ(buffer.received().size(), 2U);
    EXPECT_EQ(buffer.received()[1], std::byte{5});
    buffer.consume(99);
    EXPECT_TRUE(buffer.received().empty());
    buffer.filled(99);
    EXPECT_LE(buffer.received().size(), 8U);
}

}  // namespace
}  // namespace metier::ur_driver
