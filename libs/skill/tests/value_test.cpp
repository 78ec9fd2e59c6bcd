#include "metier/skill/value.hpp"

#include <gtest/gtest.h>

namespace metier::skill {
namespace {

TEST(Value, TellsItsType) {
    EXPECT_EQ(typeOf(Value{}), ValueType::null);
    EXPECT_EQ(typeOf(Value(true)), ValueType::boolean);
    EXPECT_EQ(typeOf(Value(std::int32_t{1})), ValueType::int32);
    EXPECT_EQ(typeOf(Value(std::uint32_t{1})), ValueType::uint32);
    EXPECT_EQ(typeOf(Value(std::uint64_t{1})), ValueType::uint64);
    EXPECT_EQ(typeOf(Value(1.0)), ValueType::number);
    EXPECT_EQ(typeOf(Value(std::string("a"))), ValueType::text);
    EXPECT_EQ(typeOf(Value(Frame{})), ValueType::frame);
    EXPECT_EQ(typeOf(Value(Vector3{})), ValueType::vector3);
    EXPECT_EQ(typeOf(Value(std::vector<double>{})), ValueType::numbers);
    EXPECT_EQ(typeOf(Value(std::vector<std::string>{})), ValueType::texts);
    EXPECT_EQ(typeOf(Value(std::vector<Range>{})), ValueType::ranges);
    EXPECT_EQ(typeOf(Value(std::vector<Frame>{})), ValueType::frames);
}

TEST(Value, IsNullOnlyIfItHoldsNothing) {
    EXPECT_TRUE(isNull(Value{}));
    EXPECT_FALSE(isNull(Value(0.0)));
    EXPECT_FALSE(isNull(Value(std::string())));
}

TEST(Value, HasATextForPeople) {
    EXPECT_EQ(toString(Value{}), "Null");
    EXPECT_EQ(toString(Value(true)), "true");
    EXPECT_EQ(toString(Value(std::int32_t{-3})), "-3");
    EXPECT_EQ(toString(Value(0.1)), "0.1");
    EXPECT_EQ(toString(Value(std::string("a{}"))), "\"a{}\"");
    EXPECT_EQ(toString(Value(Frame{1, 2, 3, 0.5, 0, 0})), "(1, 2, 3, 0.5, 0, 0)");
    EXPECT_EQ(toString(Value(Vector3{1, 2, 3})), "(1, 2, 3)");
    EXPECT_EQ(toString(Value(std::vector<double>{1, 2.5})), "[1, 2.5]");
    EXPECT_EQ(toString(Value(std::vector<std::string>{"a", "b"})), "[\"a\", \"b\"]");
    EXPECT_EQ(toString(Value(std::vector<Range>{{-1, 1}})), "[-1..1]");
    EXPECT_EQ(toString(Value(std::vector<Frame>{})), "[]");
}

TEST(ValueType, HasANameForEveryAlternative) {
    for (std::size_t i = 0; i < std::variant_size_v<Value>; ++i) {
        EXPECT_NE(toString(static_cast<ValueType>(i)), "unknown") << i;
    }
    EXPECT_EQ(toString(ValueType{99}), "unknown");
}

}  // namespace
}  // namespace metier::skill
