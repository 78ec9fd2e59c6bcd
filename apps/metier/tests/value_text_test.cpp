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

}  // namespace
}  // namespace metier::app
