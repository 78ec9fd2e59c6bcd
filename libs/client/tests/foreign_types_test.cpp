// Values of data types that skills of metier do not have.
#include "foreign_types.hpp"

#include <gmock/gmock.h>

namespace metier::client {
namespace {

using opcua::NodeId;
using skill::Value;
using skill::ValueType;

constexpr std::uint32_t kByte = 3;
constexpr std::uint32_t kInt16 = 4;
constexpr std::uint32_t kUInt16 = 5;
constexpr std::uint32_t kFloat = 10;
constexpr std::uint32_t kLocalizedText = 21;

NodeId type(std::uint32_t id) {
    return {0, id};
}

TEST(ForeignTypes, HaveAStandInThatHoldsAllTheirValues) {
    EXPECT_EQ(standInFor(type(kByte)), ValueType::int32);
    EXPECT_EQ(standInFor(type(kUInt16)), ValueType::uint32);
    EXPECT_EQ(standInFor(type(kFloat)), ValueType::number);
    EXPECT_EQ(standInFor(type(kLocalizedText)), ValueType::text);
    EXPECT_EQ(standInFor(type(11)), ValueType::null) << "Double needs none";
    EXPECT_EQ(standInFor(NodeId(1, kFloat)), ValueType::null) << "of another namespace";
}

TEST(ForeignTypes, AreConvertedThereAndBack) {
    for (const auto& [id, value] : {std::pair<std::uint32_t, Value>{kByte, 255},
                                    {kInt16, -32768},
                                    {kUInt16, 65535U},
                                    {kFloat, 0.25},
                                    {kLocalizedText, std::string("on")}}) {
        const auto sent = toForeign(value, type(id));
        ASSERT_TRUE(sent) << id << ": " << sent.error().message;
        EXPECT_EQ(sent->dataType(), type(id));
        EXPECT_EQ(fromForeign(*sent, type(id)).value(), value) << id;
    }
}

TEST(ForeignTypes, RefuseWhatTheyCannotHold) {
    EXPECT_EQ(toForeign(Value(300), type(kByte)).error().message, "300 is outside 0 to 255");
    EXPECT_EQ(toForeign(Value(-1), type(kByte)).error().code, Errc::out_of_range);
    EXPECT_EQ(toForeign(Value(65536U), type(kUInt16)).error().code, Errc::out_of_range);
    EXPECT_EQ(toForeign(Value(1e39), type(kFloat)).error().code, Errc::out_of_range);
    EXPECT_EQ(toForeign(Value(true), type(kFloat)).error().code, Errc::type_mismatch);
    EXPECT_EQ(fromForeign(opcua::Value::of(0.5), type(kFloat)).error().code, Errc::type_mismatch);
}

TEST(ForeignTypes, KeepNull) {
    EXPECT_TRUE(toForeign(Value(), type(kFloat)).value().isEmpty());
    EXPECT_EQ(fromForeign(opcua::Value(), type(kFloat)).value(), Value());
}

}  // namespace
}  // namespace metier::client
