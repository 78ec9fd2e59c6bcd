#include <gmock/gmock.h>

#include "fake_robot.hpp"

namespace metier::urscript {
namespace {

using testing::HasSubstr;

TEST(UrscriptElement, AnIndexIsAWholeNumberWithinTheList) {
    const std::string list = "a = [1, 2]\n";
    EXPECT_EQ(resultOf(list + "result = a[1.0]"), "2");
    EXPECT_EQ(resultOf(list + "result = a[-1]"), "3:11 index -1 is out of range: 2 elements");
    EXPECT_EQ(resultOf(list + "result = a[0.5]"), "3:11 an index has to be an int, not float");
    EXPECT_EQ(resultOf(list + "result = a[True]"), "3:11 an index has to be an int, not bool");
    EXPECT_EQ(resultOf(list + "result = a[\"0\"]"), "3:11 an index has to be an int, not string");
    EXPECT_EQ(resultOf(list + "result = a[1e300]"),
              "3:11 index 1e+300 is out of range: 2 elements");
    EXPECT_EQ(resultOf(list + "a[2] = 5"), "3:1 index 2 is out of range: 2 elements");
    EXPECT_EQ(resultOf("result = [][0]"), "2:12 index 0 is out of range: 0 elements");
}

TEST(UrscriptElement, OnlyListsAndPosesHaveElements) {
    EXPECT_EQ(resultOf("result = \"abc\"[0]"), "2:15 string has no elements");
    EXPECT_EQ(resultOf("result = [[1, 2], 3][1][0]"), "2:24 int has no elements");
    EXPECT_EQ(resultOf("a = [1, 2]\na[0][0] = 3"), "3:1 int has no elements");
    EXPECT_EQ(resultOf("result = p[1, 2, 3, 4, 5, 6][5]"), "6");
    EXPECT_THAT(resultOf("result = [[1, 2], [3, 4]][1, 5]"), HasSubstr("index 5 is out of range"));
}

TEST(UrscriptElement, TheNumberOfIndicesIsLimited) {
    EXPECT_EQ(parseError("x = [1][]"), "line 1, column 8: an index is missing");
    EXPECT_EQ(parseError("x = [1][0, 0, 0]"), "line 1, column 15: more than 2 values");
    EXPECT_EQ(parseError("a[] = 1"), "line 1, column 5: an index is missing before '='");
    EXPECT_EQ(parseError("a[0][0][0][0][0][0][0][0][0] = 1"),
              "line 1, column 30: more than 8 indices");
}

TEST(UrscriptElement, AssignedListsAreCopiesAlsoWithinOtherLists) {
    EXPECT_EQ(resultOf("a = [1]\nb = [a, a]\nb[0][0] = 9\na[0] = 5\nresult = [a, b]"),
              "[[5], [[9], [1]]]");
    EXPECT_EQ(resultOf("a = [1, 2]\na[0] = a\nresult = a"), "[[1, 2], 2]");
    EXPECT_EQ(resultOf("def f(l=[0]):\nl[0] = l[0] + 1\nreturn l\nend\nf()\nresult = f()"), "[1]");
}

TEST(UrscriptElement, AnAssignmentThatFailsChangesNothing) {
    FakeRobot robot;
    Interpreter interpreter(parsed(within("a = [1, [2]]\na[1][5] = 0")), robot);
    EXPECT_EQ(interpreter.step(), RunState::failed);
    EXPECT_EQ(interpreter.variable("a")->text(), "[1, [2]]");
}

TEST(UrscriptElement, ThoseOfAPoseAreSixNumbers) {
    const std::string pose = "a = p[1, 2, 3, 4, 5, 6]\n";
    EXPECT_EQ(resultOf(pose + "a[5] = 7\nresult = a[5]"), "7");
    EXPECT_EQ(resultOf(pose + "a[0] = \"x\""), "3:1 an element of a pose has to be a number");
    EXPECT_EQ(resultOf(pose + "a[0][0] = 1"), "3:1 an element of a pose has to be a number");
    EXPECT_EQ(resultOf(pose + "a[6] = 0"), "3:1 index 6 is out of range: 6 elements");
    EXPECT_EQ(resultOf(pose + "result = a[0, 0]"), "3:11 float has no elements");
    EXPECT_EQ(resultOf("a = [p[1, 2, 3, 4, 5, 6]]\na[0][1] = 0\nresult = a"),
              "[p[1, 0, 3, 4, 5, 6]]");
}

TEST(UrscriptLists, CalculateWithListsOfTheirLengthOnly) {
    EXPECT_EQ(resultOf("result = [] + []"), "[]");
    EXPECT_EQ(resultOf("result = [1, \"a\"] + [1, \"b\"]"), "[2, ab]");
    EXPECT_EQ(resultOf("result = [[1, 2], [3]] + [[1, 2], [3, 4]]"),
              "2:24 list of 1 + list of 2: the lengths differ");
    EXPECT_EQ(resultOf("result = [1, \"a\"] + 1"), "2:19 string + int is not possible");
    EXPECT_EQ(resultOf("result = [1, 1] / [1, 0]"), "2:17 division by zero");
    EXPECT_EQ(resultOf("result = [1, 2] < [1, 3]"), "2:17 list < list is not possible");
}

TEST(UrscriptLists, AScalarReachesTheListsWithin) {
    EXPECT_EQ(resultOf("result = -[1, [2, -3]]"), "[-1, [-2, 3]]");
    EXPECT_EQ(resultOf("result = 10 - [1, [2, 3]]"), "[9, [8, 7]]");
    EXPECT_EQ(resultOf("result = [\"a\", [\"b\"]] + \"x\""), "[ax, [bx]]");
}

TEST(UrscriptLists, AMatrixOnTheLeftMakesAProductOfRowsAndColumns) {
    EXPECT_EQ(resultOf("result = [[1, 2]] * [[3], [4]]"), "[[11]]");
    EXPECT_EQ(resultOf("result = [1, 2] * [[1, 2], [3, 4]]"), "[[1, 2], [6, 8]]");  // no matrix
    EXPECT_EQ(resultOf("result = [[1, 2], [3, 4]] * []"),
              "2:27 a matrix with 2 columns cannot be multiplied with 0 rows");
    EXPECT_THAT(resultOf("result = [[1, \"a\"]] * [[3], [4]]"), HasSubstr("string * int"));
}

TEST(UrscriptLists, MatricesThatWouldTakeTooLongAreRefused) {
    EXPECT_EQ(resultOf("row = make_list(300, 1)\nresult = [row] * row"), "[300]");
    EXPECT_EQ(resultOf("row = make_list(400, 1)\nresult = [row] * row"),
              "3:16 the matrices are too large to be multiplied");
}

TEST(UrscriptLists, SizesAreThoseOfTheFirstRow) {
    EXPECT_EQ(resultOf("result = [size([]), size([1, 2]), size(\"abc\")]"), "[0, 2, 3]");
    EXPECT_EQ(resultOf("result = size([[]])"), "[1, 0]");
    EXPECT_EQ(resultOf("result = [length([[1, 2], [3]]), get_list_length([[]])]"), "[2, 1]");
}

TEST(UrscriptLists, BitsAreTheThirtyTwoOfAnInteger) {
    EXPECT_EQ(resultOf("b = integer_to_binary_list(-2147483647 - 1)\nresult = [b[31], b[0]]"),
              "[True, False]");
    EXPECT_EQ(resultOf("result = binary_list_to_integer([])"), "0");
    EXPECT_EQ(resultOf("result = binary_list_to_integer(make_list(32, True))"), "-1");
    EXPECT_EQ(resultOf("result = binary_list_to_integer(make_list(40, True))"), "-1");
}

TEST(UrscriptLists, PosesInThemCalculateAsPoses) {
    EXPECT_EQ(resultOf("result = [p[1, 2, 3, 4, 5, 6]] * 2"), "[p[2, 4, 6, 8, 10, 12]]");
    EXPECT_EQ(resultOf("result = p[2, 4, 6, 8, 10, 12] / 2"), "p[1, 2, 3, 4, 5, 6]");
    EXPECT_EQ(resultOf("result = -p[1, 0, 0, 0, 0, -2] + p[1, 0, 0, 0, 0, 0]"),
              "p[0, 0, 0, 0, 0, 2]");
    EXPECT_THAT(resultOf("result = p[1, 2, 3, 4, 5, 6] / 0"), HasSubstr("division by zero"));
    EXPECT_THAT(resultOf("result = p[1, 2, 3, 4, 5, 6] * p[1, 2, 3, 4, 5, 6]"),
                HasSubstr("pose * pose is not possible"));
    EXPECT_THAT(resultOf("result = p[1, 2, 3, 4, 5, 6] % 2"), HasSubstr("pose % int"));
    EXPECT_THAT(resultOf("result = p[1, 2, 3, 4, 5, 6] < p[1, 2, 3, 4, 5, 7]"),
                HasSubstr("pose < pose is not possible"));
}

TEST(UrscriptText, FindsAndCutsWithinItsEnds) {
    EXPECT_EQ(resultOf("result = [str_find(\"abc\", \"\"), str_find(\"abc\", \"a\", 99), "
                       "str_find(\"\", \"a\")]"),
              "[0, -1, -1]");
    EXPECT_EQ(resultOf("result = str_sub(\"abcdef\", 4, 99)"), "ef");
    EXPECT_EQ(resultOf("result = str_len(str_sub(\"abcdef\", 4, 0))"), "0");
    EXPECT_EQ(resultOf("result = str_at(\"abc\", 1.9)"), "b");  // the fraction is dropped
    EXPECT_EQ(resultOf("result = str_empty(\" \")"), "False");
}

}  // namespace
}  // namespace metier::urscript
