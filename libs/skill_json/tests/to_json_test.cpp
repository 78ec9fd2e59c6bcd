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

TEST(FromJson, ReadsWhatToJsonWrote) {
    const std::vector<skill::Value> values{skill::Value{},
                                           true,
                                           std::int32_t{-3},
                                           std::uint32_t{4},
                                           std::uint64_t{1} << 60U,
                                           0.25,
                                           std::string("a\"b"),
                                           skill::Frame{1, 2, 3, 4, 5, 6},
                                           skill::Vector3{1, 2, 3},
                                           std::vector<double>{1, 2.5},
                                           std::vector<std::string>{"a", ""},
                                           std::vector<skill::Range>{{-1, 1}},
                                           std::vector<skill::Frame>{{}, {1, 2, 3, 4, 5, 6}}};
    ASSERT_EQ(values.size(), std::variant_size_v<skill::Value>);
    for (const auto& value : values) {
        const auto read = fromJson(skill::typeOf(value), toJson(value));
        ASSERT_TRUE(read) << read.error().message;
        EXPECT_EQ(*read, value) << skill::toString(value);
    }
}

TEST(FromJson, RefusesAnotherType) {
    using skill::ValueType;
    const auto refused = fromJson(ValueType::frame, nlohmann::json::parse(R"({"x":1})"));
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::type_mismatch);
    EXPECT_EQ(refused.error().message, R"({"x":1} is no frame)");
    EXPECT_FALSE(fromJson(ValueType::numbers, "text"));
    EXPECT_FALSE(fromJson(ValueType::text, 3));
    EXPECT_FALSE(fromJson(ValueType::ranges, nlohmann::json::parse("[1]")));
}

}  // namespace
}  // namespace metier::skill_json
