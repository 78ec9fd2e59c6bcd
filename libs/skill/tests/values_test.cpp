#include "metier/skill/values.hpp"

#include <gmock/gmock.h>

#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "metier/skill/json.hpp"

namespace metier::skill {
namespace {

using nlohmann::json;
using skill::Value;
using skill::ValueType;
using ::testing::HasSubstr;

std::string refusal(const json& value, ValueType type) {
    const auto read = valueFrom(value, type, "Speed");
    return read ? "taken" : read.error().message;
}

class RoundTrip : public ::testing::TestWithParam<Value> {};

TEST_P(RoundTrip, GivesTheSameValue) {
    const auto& value = GetParam();
    const auto back =
        valueFrom(json::parse(skill::toJson(value).dump()), skill::typeOf(value), "V");
    ASSERT_TRUE(back) << back.error().message;
    EXPECT_EQ(*back, value);
}

INSTANTIATE_TEST_SUITE_P(
    Values, RoundTrip,
    ::testing::Values(Value{}, Value{true}, Value{std::int32_t{-7}}, Value{std::uint32_t{7}},
                      Value{std::numeric_limits<std::uint64_t>::max()}, Value{0.25},
                      Value{std::string("täglich \"\n")}, Value{skill::Frame{1, 2, 3, 4, 5, 6}},
                      Value{skill::Vector3{1, 2, 3}}, Value{std::vector<double>{0.5, -1}},
                      Value{std::vector<std::string>{"a", ""}},
                      Value{std::vector<skill::Range>{{-1, 1}, {0, 0}}},
                      Value{std::vector<skill::Frame>{{1, 2, 3, 4, 5, 6}}}));

TEST(SkillJson, NamesAllValuesOfAMap) {
    const auto named = skill::toJson(skill::ValueMap{{"Duration", 2.5}, {"Pose", Value{}}});
    EXPECT_EQ(named, json::parse(R"({"Duration": 2.5, "Pose": null})"));
}

TEST(SkillJson, WritesAPoseByTheNamesOfAFrame) {
    EXPECT_EQ(skill::toJson(Value{skill::Frame{1, 2, 3, 4, 5, 6}}),
              json::parse(R"({"x":1.0,"y":2.0,"z":3.0,"a":4.0,"b":5.0,"c":6.0})"));
}

TEST(SkillJson, TakesSixNumbersForAPose) {
    EXPECT_EQ(valueFrom(json::parse("[1,2,3,4,5,6]"), ValueType::frame, "P").value(),
              Value(skill::Frame{1, 2, 3, 4, 5, 6}));
}

TEST(SkillJson, TakesAWholeNumberForADouble) {
    EXPECT_EQ(valueFrom(json(3), ValueType::number, "V").value(), Value(3.0));
}

TEST(SkillJson, RefusesWhatAnIntegerCannotHold) {
    EXPECT_THAT(refusal(json(5'000'000'000LL), ValueType::int32), HasSubstr("Speed: "));
    EXPECT_THAT(refusal(json(-1), ValueType::uint32), HasSubstr("-1 given"));
    EXPECT_THAT(refusal(json(1.5), ValueType::uint64), HasSubstr("1.5 given"));
    EXPECT_THAT(refusal(json(1e300), ValueType::uint64), HasSubstr("1e+300 given"));
}

TEST(SkillJson, RefusesAPoseThatLacksANumber) {
    EXPECT_THAT(refusal(json::parse(R"({"x":1,"y":2,"z":3,"a":4,"b":5})"), ValueType::frame),
                HasSubstr("given"));
    EXPECT_THAT(refusal(json::parse(R"({"x":1,"y":2,"z":3,"a":4,"b":5,"d":6})"), ValueType::frame),
                HasSubstr("given"));
    EXPECT_THAT(refusal(json::parse("[1,2,3,4,5,null]"), ValueType::frame), HasSubstr("given"));
}

TEST(SkillJson, RefusesAListWithAnElementOfAnotherKind) {
    EXPECT_THAT(refusal(json::parse("[1,\"2\"]"), ValueType::numbers),
                HasSubstr("[1,\"2\"] given"));
}

TEST(SkillJson, CutsWhatItShowsOfALongValue) {
    EXPECT_LT(refusal(json(std::string(10'000, 'x')), ValueType::number).size(), 150U);
}

}  // namespace
}  // namespace metier::skill
