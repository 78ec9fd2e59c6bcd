#include <gmock/gmock.h>

#include "fake_robot.hpp"

namespace metier::urscript {
namespace {

using testing::HasSubstr;

TEST(UrscriptScope, AFunctionDoesNotSeeTheVariablesOfItsCaller) {
    EXPECT_EQ(parseError(within("def f():\nreturn secret\nend\n"
                                "def g():\nlocal secret = 5\nreturn f()\nend\nresult = g()")),
              "line 3, column 8: variable 'secret' is not defined");
}

TEST(UrscriptScope, AFunctionWithinAnotherOneDoesNotSeeThatOnesVariables) {
    EXPECT_EQ(parseError(within("def f(x):\ndef g():\nreturn x\nend\nreturn g()\nend\n"
                                "result = f(1)")),
              "line 4, column 8: variable 'x' is not defined");
}

TEST(UrscriptScope, FunctionsAreKnownEverywhereAlsoThoseWithinOthers) {
    EXPECT_EQ(resultOf("def f():\ndef g():\nreturn 8\nend\nreturn 1\nend\nresult = g()"), "8");
}

TEST(UrscriptScope, EachCallHasItsOwnVariables) {
    EXPECT_EQ(resultOf("def f(n):\nlocal kept = n\nif n > 0:\nf(n - 1)\nend\nreturn kept\nend\n"
                       "result = f(3)"),
              "3");
}

TEST(UrscriptScope, ALocalVariableDoesNotKeepTheValueOfAnEarlierCall) {
    EXPECT_EQ(resultOf("def f(set):\nlocal kept\nif set:\nkept = 1\nend\nreturn kept\nend\n"
                       "f(True)\nf(False)"),
              "7:8 variable 'kept' has no value");
}

TEST(UrscriptScope, AVariableIsTheFunctionsOwnIfOthersHaveOnlyReadThatNameSoFar) {
    EXPECT_EQ(
        resultOf("def read():\nreturn limit\nend\ndef write():\nlimit = 3\nreturn limit\nend\n"
                 "limit = 7\na = write()\nresult = [a, limit, read()]"),
        "[3, 7, 7]");
}

TEST(UrscriptScope, ALocalVariableHidesTheGlobalOne) {
    EXPECT_EQ(resultOf("x = 1\ndef f():\nlocal x = 2\nx = x + 1\nreturn x\nend\nresult = [f(), x]"),
              "[3, 1]");
    EXPECT_EQ(resultOf("x = 5\ndef f():\nlocal x = x + 1\nreturn x\nend\nresult = [f(), x]"),
              "[6, 5]");
    EXPECT_EQ(resultOf("x = 1\ndef f(x):\nx = x * 10\nreturn x\nend\nresult = [f(4), x]"),
              "[40, 1]");
}

TEST(UrscriptScope, AnElementIsSetInTheVariableThatCanBeSeen) {
    EXPECT_EQ(resultOf("a = [1, 2]\ndef f():\na[0] = 9\nend\nf()\nresult = a"), "[9, 2]");
    EXPECT_EQ(resultOf("a = [1, 2]\ndef f():\nlocal a = [3, 4]\na[0] = 9\nreturn a\nend\n"
                       "result = [f(), a]"),
              "[[9, 4], [1, 2]]");
    EXPECT_EQ(parseError(within("def f():\nb[0] = 1\nend")),
              "line 3, column 1: variable 'b' is not defined");
}

TEST(UrscriptScope, AVariableHasNoValueBeforeItsAssignmentIsCarriedOut) {
    EXPECT_EQ(resultOf("if False:\nx = 1\nend\nresult = x"), "5:10 variable 'x' has no value");
    EXPECT_EQ(resultOf("def f():\nreturn limit\nend\nresult = f()\nlimit = 4"),
              "3:8 variable 'limit' has no value");
    EXPECT_EQ(resultOf("global x\nresult = x"), "3:10 variable 'x' has no value");
}

TEST(UrscriptScope, AFunctionThatReturnsNothingGivesNoValue) {
    const std::string nothing = "def f():\npass\nend\n";
    EXPECT_EQ(resultOf(nothing + "x = f()\nresult = x"), "6:10 variable 'x' has no value");
    EXPECT_THAT(resultOf(nothing + "result = f() + 1"), HasSubstr("none + int is not possible"));
    EXPECT_THAT(resultOf(nothing + "if f():\nend"), HasSubstr("has to be a bool, not none"));
    EXPECT_THAT(resultOf(nothing + "sleep(f())"), HasSubstr("has to be a number, not none"));
    EXPECT_THAT(resultOf("def g():\nreturn\nend\nresult = g() * 2"), HasSubstr("none * int"));
}

TEST(UrscriptScope, AFunctionOfTheScriptHidesOneOfTheController) {
    EXPECT_EQ(resultOf("def sqrt(x):\nreturn x * 100\nend\nresult = sqrt(4)"), "400");
    EXPECT_EQ(resultOf("def sync(a, b):\nreturn a + b\nend\nresult = sync(1, 2)"), "3");
}

TEST(UrscriptScope, ADefaultIsCalculatedAtEachCallThatNeedsIt) {
    EXPECT_EQ(resultOf("n = 0\ndef next():\nn = n + 1\nreturn n\nend\ndef f(a=next()):\nreturn a\n"
                       "end\nresult = [f(), f(50), f()]"),
              "[1, 50, 2]");
    EXPECT_EQ(resultOf("def f(a, b=a * 2):\nreturn b\nend\nresult = f(4)"), "8");
}

TEST(UrscriptScope, ADefaultMayUseOnlyTheParametersBeforeIt) {
    EXPECT_EQ(parseError(within("def f(a=b, b=1):\nend")),
              "line 2, column 9: variable 'b' is not defined");
    EXPECT_EQ(parseError(within("def f(a, a):\nend")),
              "line 2, column 10: parameter 'a' is there twice");
}

TEST(UrscriptScope, AParameterBeforeOneWithoutDefaultHasToBeGiven) {
    EXPECT_EQ(parseError(within("def f(a=1, b):\nend\nf(b=2)")),
              "line 4, column 1: f needs an argument for 'a'");
}

TEST(UrscriptScope, ArgumentsAreCalculatedInTheOrderInWhichTheyAreWritten) {
    EXPECT_EQ(resultOf("result = \"\"\ndef note(x):\nresult = str_cat(result, x)\nreturn x\nend\n"
                       "def f(a, b, c):\nend\nf(c=note(\"c\"), a=note(\"a\"), b=note(\"b\"))"),
              "cab");
}

TEST(UrscriptScope, AReturnLeavesAllLoopsOfItsFunctionAndNoOther) {
    EXPECT_EQ(resultOf("def f():\nwhile True:\nwhile True:\nreturn 1\nend\nend\nend\n"
                       "result = 0\nwhile result < 3:\nresult = result + f()\nend"),
              "3");
}

TEST(UrscriptScope, BreakAndContinueAreForTheInnerLoop) {
    EXPECT_EQ(resultOf("sum = 0\ni = 0\nwhile i < 3:\ni = i + 1\nj = 0\nwhile True:\n"
                       "j = j + 1\nif j == 2:\ncontinue\nend\nif j > 3:\nbreak\nend\n"
                       "sum = sum + j\nend\nend\nresult = sum"),
              "12");  // three times 1 + 3
}

}  // namespace
}  // namespace metier::urscript
