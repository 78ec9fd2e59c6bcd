#include "metier/skill/json.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace metier::skill {
namespace {

TEST(Json, TellsEveryKindOfValue) {
    EXPECT_EQ(jsonOf(Value{}), "null");
    EXPECT_EQ(jsonOf(Value{true}), "true");
    EXPECT_EQ(jsonOf(Value{std::int32_t{-3}}), "-3");
    EXPECT_EQ(jsonOf(Value{std::uint64_t{18446744073709551615U}}), "18446744073709551615");
    EXPECT_EQ(jsonOf(Value{0.1}), "0.1");
    EXPECT_EQ(jsonOf(Value{-2.0}), "-2");
    EXPECT_EQ(jsonOf(Value{1e-7}), "1e-07");
    EXPECT_EQ(jsonOf(Value{1e15}), "1e+15");
    EXPECT_EQ(jsonOf(Value{999999999999999.0}), "999999999999999");
    EXPECT_EQ(jsonOf(Value{Frame{1, 2, 3, 0.5, 0, -1}}),
              R"({"x":1,"y":2,"z":3,"a":0.5,"b":0,"c":-1})");
    EXPECT_EQ(jsonOf(Value{Vector3{1, 2, 3}}), R"({"x":1,"y":2,"z":3})");
    EXPECT_EQ(jsonOf(Value{std::vector<double>{1, 2.5}}), "[1,2.5]");
    EXPECT_EQ(jsonOf(Value{std::vector<std::string>{"a", "b"}}), R"(["a","b"])");
    EXPECT_EQ(jsonOf(Value{std::vector<Range>{{0, 1}}}), R"([{"low":0,"high":1}])");
    EXPECT_EQ(jsonOf(Value{std::vector<Frame>{}}), "[]");
}

TEST(Json, HasNoNumberThatIsNotFinite) {
    EXPECT_EQ(jsonOf(Value{std::numeric_limits<double>::infinity()}), "null");
    EXPECT_EQ(jsonOf(Value{std::numeric_limits<double>::quiet_NaN()}), "null");
}

TEST(Json, EscapesTexts) {
    EXPECT_EQ(jsonOf(Value{std::string("a\"b\\c\n\x01")}), R"("a\"b\\c\n\u0001")");
    EXPECT_EQ(jsonOf(Value{std::string("\xC3\xBC")}), "\"\xC3\xBC\"");
    EXPECT_EQ(jsonOf(Value{std::string("a\xFF")}), "\"a\xEF\xBF\xBD\"");
}

TEST(Json, TellsValuesByName) {
    EXPECT_EQ(jsonOf(ValueMap{}), "{}");
    EXPECT_EQ(jsonOf(ValueMap{{"Speed", 0.5}, {"Seam \"1\"", Value{}}}),
              R"({"Seam \"1\"":null,"Speed":0.5})");
}

TEST(ToJson, KeepsNumbersTextsAndLists) {
    EXPECT_EQ(toJson(Value(0.25)).dump(), "0.25");
    EXPECT_EQ(toJson(Value(std::string("a\"b"))).dump(), R"("a\"b")");
    EXPECT_EQ(toJson(Value(std::vector<double>{1, 2.5})).dump(), "[1.0,2.5]");
    EXPECT_EQ(toJson(Value(true)).dump(), "true");
}

TEST(ToJson, TakesNullForNull) {
    EXPECT_TRUE(toJson(Value{}).is_null());
}

TEST(ToJson, NamesTheComponentsOfAFrame) {
    const auto json = toJson(Value(Frame{1, 2, 3, 4, 5, 6}));
    EXPECT_EQ(json.at("x"), 1);
    EXPECT_EQ(json.at("c"), 6);
}

TEST(ToJson, WritesRangesAndFramesAsLists) {
    const auto ranges = toJson(Value(std::vector<Range>{{-1, 1}}));
    ASSERT_EQ(ranges.size(), 1U);
    EXPECT_EQ(ranges[0].at("low"), -1);
    EXPECT_EQ(toJson(Value(std::vector<Frame>{{}, {}})).size(), 2U);
}

TEST(ToJson, SaysWhatTheTextOfARecordSays) {
    const ValueMap values{{"Nothing", Value{}},
                          {"Flag", true},
                          {"Int", std::int32_t{-7}},
                          {"Unsigned", std::uint32_t{7}},
                          {"Long", std::uint64_t{18'446'744'073'709'551'615U}},
                          {"Number", 0.1},
                          {"Infinite", std::numeric_limits<double>::infinity()},
                          {"Text", std::string("a\"b\\\n\x01 \xc3\xa4")},
                          {"Frame", Frame{1, 2, 3, 4, 5, 6}},
                          {"Vector", Vector3{1, 2, 3}},
                          {"Numbers", std::vector<double>{1, 2.5}},
                          {"Texts", std::vector<std::string>{"a", ""}},
                          {"Ranges", std::vector<Range>{{-1, 1}}},
                          {"Frames", std::vector<Frame>{{}, {1, 2, 3, 4, 5, 6}}}};
    EXPECT_EQ(nlohmann::json::parse(jsonOf(values)), nlohmann::json::parse(toJson(values).dump()));
}

TEST(ToJson, NamesTheValuesOfAMap) {
    const auto json = toJson(ValueMap{{"Duration", 1.5}, {"Part", Value{}}});
    EXPECT_EQ(json.at("Duration"), 1.5);
    EXPECT_TRUE(json.at("Part").is_null());
}

}  // namespace
}  // namespace metier::skill
