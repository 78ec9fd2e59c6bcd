#include "metier/skill/field.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "metier/base/numbers.hpp"

namespace metier::skill {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Field forceField() {
    return {.name = "Force",
            .type = ValueType::number,
            .unit = kNewton,
            .range = Range{5.0, 80.0},
            .default_value = 20.0};
}

Field velocityField() {
    return {.name = "MaxVelocity",
            .type = ValueType::numbers,
            .unit = kRadianPerSecond,
            .range = Range{0.0, 3.14},
            .length = LengthLimit{6, 7}};
}

Error refusal(const Field& field, const Value& value) {
    const auto checked = checkValue(field, value);
    EXPECT_FALSE(checked) << toString(value);
    return checked ? Error{} : checked.error();
}

TEST(CheckValue, AcceptsTheEndsOfTheRange) {
    EXPECT_TRUE(checkValue(forceField(), 5.0));
    EXPECT_TRUE(checkValue(forceField(), 80.0));
}

TEST(CheckValue, AcceptsNullWhichMeansTheDefault) {
    EXPECT_TRUE(checkValue(forceField(), Value{}));
}

TEST(CheckValue, RefusesWhatIsBeyondTheRangeWithValueLimitAndUnit) {
    const auto over = refusal(forceField(), 80.5);
    EXPECT_EQ(over.code, Errc::out_of_range);
    EXPECT_EQ(over.message, "Force: 80.5 N is over the limit 80 N");
    EXPECT_EQ(refusal(forceField(), 4.0).message, "Force: 4 N is under the limit 5 N");
}

TEST(CheckValue, LeavesOutAUnitThatHasNoSymbol) {
    auto field = forceField();
    field.unit = kOne;
    EXPECT_EQ(refusal(field, 81.0).message, "Force: 81 is over the limit 80");
}

TEST(CheckValue, RefusesWhatIsNotFinite) {
    for (const auto value : {kNan, kInfinity, -kInfinity}) {
        const auto error = refusal(forceField(), value);
        EXPECT_EQ(error.code, Errc::out_of_range);
        EXPECT_THAT(error.message, HasSubstr("not finite"));
    }
    Field without_range{.name = "Free", .type = ValueType::number};
    EXPECT_EQ(refusal(without_range, kNan).code, Errc::out_of_range);
    EXPECT_TRUE(checkValue(without_range, std::numeric_limits<double>::denorm_min()));
}

TEST(CheckValue, RefusesAnotherTypeAlsoIfItCouldBeConverted) {
    const auto error = refusal(forceField(), std::int32_t{20});
    EXPECT_EQ(error.code, Errc::type_mismatch);
    EXPECT_EQ(error.message, "Force: number expected, int32 given");
    EXPECT_EQ(refusal(forceField(), std::vector<double>{20.0}).code, Errc::type_mismatch);
}

TEST(CheckValue, ChecksWholeNumbersAgainstTheRange) {
    const Field count{.name = "Count", .type = ValueType::uint64, .range = Range{1, 10}};
    EXPECT_TRUE(checkValue(count, std::uint64_t{10}));
    EXPECT_EQ(refusal(count, std::uint64_t{11}).message, "Count: 11 is over the limit 10");
    const Field offset{.name = "Offset", .type = ValueType::int32, .range = Range{-2, 2}};
    EXPECT_EQ(refusal(offset, std::int32_t{-3}).message, "Offset: -3 is under the limit -2");
}

TEST(CheckValue, NamesTheElementOfAList) {
    auto values = std::vector<double>(6, 1.0);
    EXPECT_TRUE(checkValue(velocityField(), values));
    values[4] = 4.0;
    EXPECT_EQ(refusal(velocityField(), values).message,
              "MaxVelocity[4]: 4 rad/s is over the limit 3.14 rad/s");
    values[2] = kNan;
    EXPECT_THAT(refusal(velocityField(), values).message, StartsWith("MaxVelocity[2]: nan rad/s"));
}

TEST(CheckValue, RefusesShortEmptyAndOversizedLists) {
    for (const std::size_t size : {0U, 5U}) {
        const auto error = refusal(velocityField(), std::vector<double>(size));
        EXPECT_EQ(error.code, Errc::out_of_range);
        EXPECT_THAT(error.message, HasSubstr("fewer than 6"));
    }
    EXPECT_TRUE(checkValue(velocityField(), std::vector<double>(7)));
    EXPECT_EQ(refusal(velocityField(), std::vector<double>(8)).message,
              "MaxVelocity: 8 elements are more than 7");
}

TEST(CheckValue, LimitsTheLengthOfTexts) {
    const Field tool{.name = "ToolFrame", .type = ValueType::text, .length = LengthLimit{1, 4}};
    EXPECT_TRUE(checkValue(tool, std::string("grip")));
    EXPECT_EQ(refusal(tool, std::string()).code, Errc::out_of_range);
    EXPECT_EQ(refusal(tool, std::string("gripper")).code, Errc::out_of_range);
}

TEST(CheckValue, ChecksEachPartOfAFrame) {
    const Field target{.name = "Target", .type = ValueType::frame};
    EXPECT_TRUE(checkValue(target, Frame{1, 2, 3, 0, 0, 0}));
    EXPECT_EQ(refusal(target, Frame{.b = kNan}).message, "Target.b: nan is not finite");
    const Field path{.name = "Path", .type = ValueType::frames};
    EXPECT_EQ(refusal(path, std::vector<Frame>{{}, {.z = kInfinity}}).message,
              "Path[1].z: inf is not finite");
}

TEST(CheckValue, ChecksEachPartOfAVector) {
    const Field force{
        .name = "Force", .type = ValueType::vector3, .unit = kNewton, .range = Range{-50, 50}};
    EXPECT_TRUE(checkValue(force, Vector3{1, 2, 3}));
    EXPECT_EQ(refusal(force, Vector3{0, -51, 0}).message,
              "Force.y: -51 N is under the limit -50 N");
}

TEST(CheckValue, RefusesARangeWhoseLowEndIsOverItsHighEnd) {
    const Field bounds{.name = "AxisBounds", .type = ValueType::ranges, .unit = kRadian};
    EXPECT_TRUE(checkValue(bounds, std::vector<Range>{{0, 0}, {-1, 1}}));
    EXPECT_EQ(refusal(bounds, std::vector<Range>{{-1, 1}, {2, 1}}).message,
              "AxisBounds[1]: low 2 rad is over high 1 rad");
    EXPECT_EQ(refusal(bounds, std::vector<Range>{{-1, kNan}}).code, Errc::out_of_range);
}

TEST(CheckValue, AsksTheExtraCheckLastAndNeverForNull) {
    auto field = forceField();
    int asked = 0;
    field.extra_check = [&](const Value& value) -> Result<void> {
        ++asked;
        return std::get<double>(value) == 13.0
                   ? Result<void>(fail(Errc::invalid_argument, "unlucky"))
                   : Result<void>{};
    };
    EXPECT_TRUE(checkValue(field, Value{}));
    EXPECT_FALSE(checkValue(field, 99.0));
    EXPECT_EQ(asked, 0);
    EXPECT_TRUE(checkValue(field, 12.0));
    EXPECT_EQ(refusal(field, 13.0).message, "Force: unlucky");
    EXPECT_EQ(refusal(field, 13.0).code, Errc::invalid_argument);
}

TEST(CheckValue, AcceptsBooleansAndLists) {
    EXPECT_TRUE(checkValue({.name = "On", .type = ValueType::boolean}, true));
    EXPECT_TRUE(
        checkValue({.name = "Names", .type = ValueType::texts}, std::vector<std::string>{"a", ""}));
}

TEST(ValueOrDefault, PrefersTheValue) {
    EXPECT_EQ(valueOrDefault(forceField(), 30.0), Value(30.0));
    EXPECT_EQ(valueOrDefault(forceField(), Value{}), Value(20.0));
}

TEST(ValueOrDefault, RefusesNullOnlyIfItIsNeitherDefaultedNorOptional) {
    EXPECT_EQ(valueOrDefault(velocityField(), Value{}).error().code, Errc::invalid_argument);
    auto optional = velocityField();
    optional.optional = true;
    EXPECT_EQ(valueOrDefault(optional, Value{}), Value{});
}

}  // namespace
}  // namespace metier::skill
