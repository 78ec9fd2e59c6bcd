#include "metier/skill_json/values.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "metier/skill/json.hpp"

namespace metier::skill_json {
namespace {

TEST(ToJson, KeepsNumbersTextsAndLists) {
    EXPECT_EQ(toJson(skill::Value(0.25)).dump(), "0.25");
    EXPECT_EQ(toJson(skill::Value(std::string("a\"b"))).dump(), R"("a\"b")");
    EXPECT_EQ(toJson(skill::Value(std::vector<double>{1, 2.5})).dump(), "[1.0,2.5]");
    EXPECT_EQ(toJson(skill::Value(true)).dump(), "true");
}

TEST(ToJson, TakesNullForNull) {
    EXPECT_TRUE(toJson(skill::Value{}).is_null());
}

TEST(ToJson, NamesTheComponentsOfAFrame) {
    const auto json = toJson(skill::Value(skill::Frame{1, 2, 3, 4, 5, 6}));
    EXPECT_EQ(json.at("x"), 1);
    EXPECT_EQ(json.at("c"), 6);
}

TEST(ToJson, WritesRangesAndFramesAsLists) {
    const auto ranges = toJson(skill::Value(std::vector<skill::Range>{{-1, 1}}));
    ASSERT_EQ(ranges.size(), 1U);
    EXPECT_EQ(ranges[0].at("low"), -1);
    EXPECT_EQ(toJson(skill::Value(std::vector<skill::Frame>{{}, {}})).size(), 2U);
}

TEST(ToJson, SaysWhatTheTextOfARecordSays) {
    const skill::ValueMap values{{"Nothing", skill::Value{}},
                                 {"Flag", true},
                                 {"Int", std::int32_t{-7}},
                                 {"Unsigned", std::uint32_t{7}},
                                 {"Long", std::uint64_t{18'446'744'073'709'551'615U}},
                                 {"Number", 0.1},
                                 {"Infinite", std::numeric_limits<double>::infinity()},
                                 {"Text", std::string("a\"b\\\n\x01 \xc3\xa4")},
                                 {"Frame", skill::Frame{1, 2, 3, 4, 5, 6}},
                                 {"Vector", skill::Vector3{1, 2, 3}},
                                 {"Numbers", std::vector<double>{1, 2.5}},
                                 {"Texts", std::vector<std::string>{"a", ""}},
                                 {"Ranges", std::vector<skill::Range>{{-1, 1}}},
                                 {"Frames", std::vector<skill::Frame>{{}, {1, 2, 3, 4, 5, 6}}}};
    EXPECT_EQ(nlohmann::json::parse(skill::jsonOf(values)),
              nlohmann::json::parse(toJson(values).dump()));
}

TEST(ToJson, NamesTheValuesOfAMap) {
    const auto json = toJson(skill::ValueMap{{"Duration", 1.5}, {"Part", skill::Value{}}});
    EXPECT_EQ(json.at("Duration"), 1.5);
    EXPECT_TRUE(json.at("Part").is_null());
}

}  // namespace
}  // namespace metier::skill_json
