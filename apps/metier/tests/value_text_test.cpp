#include "value_text.hpp"

#include <gmock/gmock.h>

namespace metier::app {
namespace {

using skill::Value;
using skill::ValueType;
using ::testing::HasSubstr;

TEST(ParseValue, ReadsEachTypeInItsNotation) {
    EXPECT_EQ(parseValue(ValueType::number, "-0.25").value(), Value(-0.25));
    EXPECT_EQ(parseValue(ValueType::int32, "-3").value(), Value(std::int32_t{-3}));
    EXPECT_EQ(parseValue(ValueType::uint32, "3").value(), Value(std::uint32_t{3}));
    EXPECT_EQ(parseValue(ValueType::boolean, "true").value(), Value(true));
    EXPECT_EQ(parseValue(ValueType::text, "a,b").value(), Value(std::string("a,b")));
    EXPECT_EQ(parseValue(ValueType::numbers, "1, 2.5,3e-3").value(),
              Value(std::vector<double>{1, 2.5, 3e-3}));
    EXPECT_EQ(parseValue(ValueType::frame, "1,2,3,0.1,0.2,0.3").value(),
              Value(skill::Frame{1, 2, 3, 0.1, 0.2, 0.3}));
    EXPECT_EQ(parseValue(ValueType::ranges, "-1:1,0:2").value(),
              Value(std::vector<skill::Range>{{-1, 1}, {0, 2}}));
    EXPECT_EQ(parseValue(ValueType::frames, "1,0,0,0,0,0;2,0,0,0,0,0").value(),
              Value(std::vector<skill::Frame>{{1, 0, 0, 0, 0, 0}, {2, 0, 0, 0, 0, 0}}));
}

TEST(ParseValue, TakesNullForEveryType) {
    EXPECT_TRUE(skill::isNull(parseValue(ValueType::frame, "null").value()));
    EXPECT_TRUE(skill::isNull(parseValue(ValueType::text, "null").value()));
}

TEST(ParseValue, RefusesWithWhatWasGivenAndWhatIsExpected) {
    const auto frame = parseValue(ValueType::frame, "1,2,3");
    ASSERT_FALSE(frame);
    EXPECT_EQ(frame.error().code, Errc::invalid_argument);
    EXPECT_THAT(frame.error().message, HasSubstr("'1,2,3' is not written as x,y,z,a,b,c"));
    EXPECT_FALSE(parseValue(ValueType::number, "1m"));
    EXPECT_FALSE(parseValue(ValueType::number, ""));
    EXPECT_FALSE(parseValue(ValueType::numbers, "1,,2"));
    EXPECT_FALSE(parseValue(ValueType::uint32, "-1"));
    EXPECT_FALSE(parseValue(ValueType::ranges, "1:2:3"));
    EXPECT_FALSE(parseValue(ValueType::boolean, "yes"));
}

/// One text that each type takes.
constexpr std::pair<ValueType, const char*> kExamples[] = {
    {ValueType::boolean, "false"},     {ValueType::int32, "-2147483648"},
    {ValueType::uint32, "4294967295"}, {ValueType::uint64, "18446744073709551615"},
    {ValueType::number, "1e-3"},       {ValueType::text, "any text"},
    {ValueType::frame, "1,2,3,4,5,6"}, {ValueType::vector3, "1,2,3"},
    {ValueType::numbers, "1,2"},       {ValueType::texts, "a,b"},
    {ValueType::ranges, "-1:1"},       {ValueType::frames, "1,2,3,4,5,6"}};

TEST(ParseValue, GivesAValueOfTheTypeThatIsAskedFor) {
    for (const auto& [type, text] : kExamples) {
        const auto value = parseValue(type, text);
        ASSERT_TRUE(value) << value.error().message;
        EXPECT_EQ(skill::typeOf(*value), type) << text;
    }
}

TEST(ParseValue, RefusesNumbersBeyondTheirType) {
    EXPECT_FALSE(parseValue(ValueType::int32, "2147483648"));
    EXPECT_FALSE(parseValue(ValueType::uint32, "4294967296"));
    EXPECT_FALSE(parseValue(ValueType::uint64, "18446744073709551616"));
    EXPECT_FALSE(parseValue(ValueType::uint64, "-1"));
    EXPECT_FALSE(parseValue(ValueType::int32, "1.0"));
    EXPECT_FALSE(parseValue(ValueType::number, "1e999"));
}

TEST(ParseValue, SaysForEachTypeHowItIsWritten) {
    for (const auto& [type, text] : kExamples) {
        if (type == ValueType::text || type == ValueType::texts) {
            continue;  // which take every text
        }
        for (const char* wrong : {"x", "1;", "1:2:3", "1,2,", "true,", "--1", "0x1"}) {
            const auto refused = parseValue(type, wrong);
            ASSERT_FALSE(refused) << wrong << " as " << skill::toString(type);
            EXPECT_EQ(refused.error().message, "'" + std::string(wrong) + "' is not written as " +
                                                   std::string(notation(type)));
        }
    }
}

TEST(ParseValue, AnEmptyTextIsAnEmptyListAndNoNumber) {
    EXPECT_EQ(parseValue(ValueType::numbers, "").value(), Value(std::vector<double>{}));
    EXPECT_EQ(parseValue(ValueType::texts, "").value(), Value(std::vector<std::string>{}));
    EXPECT_EQ(parseValue(ValueType::text, "").value(), Value(std::string()));
    for (const auto type : {ValueType::number, ValueType::int32, ValueType::boolean,
                            ValueType::frame, ValueType::vector3, ValueType::null}) {
        EXPECT_FALSE(parseValue(type, "")) << skill::toString(type);
    }
}

TEST(ParseValue, FramesInAListAreCountedEach) {
    EXPECT_FALSE(parseValue(ValueType::frames, "1,2,3,4,5,6;"));
    EXPECT_FALSE(parseValue(ValueType::frames, "1,2,3,4,5,6;1,2,3"));
    EXPECT_FALSE(parseValue(ValueType::frame, "1,2,3,4,5,6,7"));
    EXPECT_FALSE(parseValue(ValueType::vector3, "1,2"));
    EXPECT_FALSE(parseValue(ValueType::ranges, "1:2,3"));
}

}  // namespace
}  // namespace metier::app
