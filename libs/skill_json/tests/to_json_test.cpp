#include "metier/skill_json/values.hpp"

#include <gtest/gtest.h>

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

TEST(ToJson, NamesTheValuesOfAMap) {
    const auto json = toJson(skill::ValueMap{{"Duration", 1.5}, {"Part", skill::Value{}}});
    EXPECT_EQ(json.at("Duration"), 1.5);
    EXPECT_TRUE(json.at("Part").is_null());
}

}  // namespace
}  // namespace metier::skill_json
