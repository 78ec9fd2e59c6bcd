#include <gmock/gmock.h>

#include "fake_robot.hpp"

namespace metier::urscript {
namespace {

using testing::HasSubstr;

constexpr const char* kLeast = "least = -2147483647 - 1\n";  // of 32 bits

TEST(UrscriptArithmetic, IntegersBeginAnewBeyondThirtyTwoBits) {
    EXPECT_EQ(resultOf("result = -2147483647 - 2"), "2147483647");
    EXPECT_EQ(resultOf("result = 65536 * 65536"), "0");
    EXPECT_EQ(resultOf("result = 2147483647 * 2"), "-2");
    EXPECT_EQ(resultOf(kLeast + std::string("result = -least")), "-2147483648");
    EXPECT_EQ(resultOf(kLeast + std::string("result = least % -1")), "0");
    EXPECT_EQ(resultOf(kLeast + std::string("abs(least)")),
              "3:1 abs: the result is not an integer of 32 bits");
    EXPECT_EQ(resultOf("result = 2147483647 + 1.0"), "2.14748e+09");
}

TEST(UrscriptArithmetic, RoundingReachesBothEndsOfTheIntegers) {
    EXPECT_EQ(resultOf("result = floor(2147483647.5)"), "2147483647");
    EXPECT_EQ(resultOf("result = ceil(-2147483648.5)"), "-2147483648");
    EXPECT_EQ(resultOf("result = round(-2147483648.0)"), "-2147483648");
    EXPECT_THAT(resultOf("ceil(2147483647.5)"), HasSubstr("not an integer of 32 bits"));
    EXPECT_THAT(resultOf("floor(-2147483648.5)"), HasSubstr("not an integer of 32 bits"));
    EXPECT_EQ(resultOf("result = [round(-0.5), round(2.5), ceil(-0.5)]"), "[-1, 3, 0]");
}

TEST(UrscriptArithmetic, ARemainderHasTheSignOfTheDividend) {
    EXPECT_EQ(resultOf("result = [-7 % 4, 7 % -4, -5.5 % 2]"), "[-3, 3, -1.5]");
    EXPECT_EQ(resultOf("result = 5 % 0"), "2:12 division by zero");
    EXPECT_EQ(resultOf("result = 5 % 0.0"), "2:12 division by zero");
    EXPECT_EQ(resultOf("result = 0.0 / 0"), "2:14 division by zero");
}

TEST(UrscriptArithmetic, OperatorsBindInTheOrderOfTheirLevels) {
    EXPECT_EQ(resultOf("result = 2 - - -3"), "-1");
    EXPECT_EQ(resultOf("result = -2 * -3"), "6");
    EXPECT_EQ(resultOf("result = 2 + 3 * 4 % 5 - 6 / 3"), "2");
    EXPECT_EQ(resultOf("result = -[1, 2][1]"), "-2");
    EXPECT_EQ(resultOf("result = not 1 == 2"), "True");
    EXPECT_EQ(resultOf("result = False or True and False"), "False");
    EXPECT_EQ(resultOf("result = True xor False or True"), "False");
    EXPECT_EQ(resultOf("result = 1 + 2 == 3 and 4 > 3 xor True"), "False");
}

TEST(UrscriptArithmetic, ComparisonsGoFromLeftToRight) {
    EXPECT_EQ(resultOf("result = 1 < 2 == True"), "True");
    EXPECT_EQ(resultOf("result = 1 < 2 < 3"), "2:16 bool < int is not possible");
}

TEST(UrscriptArithmetic, BoolsAreComparedWithNumbersButDoNotCalculate) {
    EXPECT_EQ(resultOf("result = [True == 1, True != 2, False == 0.0]"), "[True, True, True]");
    EXPECT_EQ(resultOf("result = True + 1"), "2:15 bool + int is not possible");
    EXPECT_EQ(resultOf("result = -True"), "2:10 -bool is not possible");
    EXPECT_EQ(resultOf("result = True < False"), "2:15 bool < bool is not possible");
}

TEST(UrscriptArithmetic, NumbersAndStringsAreConditions) {
    EXPECT_EQ(resultOf("result = [1 and \"a\", 0.0 or \"\", not 0.5, 1 xor \"\"]"),
              "[True, False, False, True]");
    EXPECT_EQ(resultOf("result = [2 and 3, 0 or 4]"), "[True, True]");
}

TEST(UrscriptArithmetic, ListsAndPosesAreNoConditions) {
    EXPECT_EQ(resultOf("result = 0 or [1]"), "2:12 a condition has to be a bool, not list");
    EXPECT_EQ(resultOf("result = [1] xor 1"), "2:14 list xor int is not possible");
    EXPECT_THAT(resultOf("while p[0, 0, 0, 0, 0, 0]:\nend"), HasSubstr("a bool, not pose"));
    EXPECT_THAT(resultOf("result = not []"), HasSubstr("a bool, not list"));
    EXPECT_EQ(resultOf("result = 0 and [1]"), "False");  // nobody looks at it
}

TEST(UrscriptArithmetic, StringsAreComparedByTheirCharacters) {
    EXPECT_EQ(
        resultOf("result = [\"abc\" < \"abd\", \"10\" < \"9\", \"\" < \"a\", \"b\" >= \"b\"]"),
        "[True, True, True, True]");
    EXPECT_THAT(resultOf("result = \"a\" < 1"), HasSubstr("string < int is not possible"));
    EXPECT_THAT(resultOf("result = \"a\" - \"b\""), HasSubstr("string - string is not possible"));
    EXPECT_THAT(resultOf("result = -\"a\""), HasSubstr("-string is not possible"));
}

TEST(UrscriptArithmetic, ValuesOfDifferentKindsAreNeverEqual) {
    EXPECT_EQ(resultOf("result = [\"1\" == 1, [1] == 1, [] == \"\", [1, [2]] == [1, 2]]"),
              "[False, False, False, False]");
    EXPECT_EQ(resultOf("result = p[0, 0, 0, 0, 0, 0] != [0, 0, 0, 0, 0, 0]"), "True");
    EXPECT_EQ(resultOf("result = [1, [2.0]] == [1.0, [2]]"), "True");
}

TEST(UrscriptArithmetic, WhatIsNotANumberIsEqualToNothing) {
    const std::string nan = "x = to_num(\"nan\")\n";
    EXPECT_EQ(resultOf(nan + "result = [x == x, x != x, x < 1, x > 1]"),
              "[False, True, False, False]");
    EXPECT_EQ(resultOf(nan + "floor(x)"), "3:1 floor: the result is not an integer of 32 bits");
    EXPECT_THAT(resultOf(nan + "a = [1]\na[x] = 2"), HasSubstr("an index has to be an int"));
    EXPECT_THAT(resultOf(nan + "set_tool_voltage(x)"), HasSubstr("an integer of 32 bits"));
}

TEST(UrscriptArithmetic, FloatsThatGrowWithoutEndBecomeInfinite) {
    EXPECT_EQ(resultOf("x = 1e308 * 10\nresult = [x, -x, x > 1e308]"), "[inf, -inf, True]");
    EXPECT_EQ(resultOf("result = pow(10, 400)"), "inf");
    EXPECT_EQ(resultOf("asin(1e308 * 10)"), "2:1 asin: the argument has to be from -1 to 1");
}

TEST(UrscriptArithmetic, NumbersAreReadAsTheyAreWritten) {
    EXPECT_EQ(resultOf("result = [1e3, 1.5E-2, .25, 7., 00012, 2147483648]"),
              "[1000, 0.015, 0.25, 7, 12, 2.14748e+09]");
    EXPECT_EQ(parseError("x = 1e400"), "line 1, column 5: this number cannot be represented");
    EXPECT_EQ(parseError("x = 0x1F"),
              "line 1, column 5: a number and a name need a blank between them");
    EXPECT_EQ(parseError("x = 1e"),
              "line 1, column 5: a number and a name need a blank between them");
    EXPECT_EQ(parseError("x = 1.2.3"),
              "line 1, column 8: the end of the line is missing before '.3'");
}

TEST(UrscriptArithmetic, TextBecomesTheKindOfNumberThatItShows) {
    EXPECT_EQ(resultOf("result = to_num(\"2147483647\") + 1"), "-2147483648");  // an int
    EXPECT_EQ(resultOf("result = to_num(\"2147483648\") + 1"), "2.14748e+09");
    EXPECT_EQ(resultOf("result = to_num(\"2147483647.\") + 1"), "2.14748e+09");
    EXPECT_EQ(resultOf("result = to_num(\"-7\\t\")"), "2:10 to_num: '-7\\t' is not a number");
    EXPECT_EQ(resultOf("result = to_num(\"  \")"), "2:10 to_num: '  ' is not a number");
    EXPECT_EQ(resultOf("result = to_num(\"1e999\")"), "2:10 to_num: '1e999' is not a number");
}

}  // namespace
}  // namespace metier::urscript
