#include <gmock/gmock.h>

#include "fake_robot.hpp"

namespace metier::urscript {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

TEST(UrscriptLanguage, CountsIntegersAndFloatsAsTheControllerDoes) {
    EXPECT_EQ(resultOf("result = 1 + 2 * 3 - 4"), "3");
    EXPECT_EQ(resultOf("result = (1 + 2) * 3"), "9");
    EXPECT_EQ(resultOf("result = 5 / 2"), "2.5");  // a division is never one of integers
    EXPECT_EQ(resultOf("result = 7 % 4"), "3");
    EXPECT_EQ(resultOf("result = 5.5 % 2"), "1.5");
    EXPECT_EQ(resultOf("result = -2 - -3"), "1");
    EXPECT_EQ(resultOf("result = 1e-3 * 2."), "0.002");
    EXPECT_EQ(resultOf("result = .5 + 1"), "1.5");
    EXPECT_EQ(resultOf("result = 2147483647 + 1"), "-2147483648");
    EXPECT_EQ(resultOf("result = 3000000000"), "3e+09");
}

TEST(UrscriptLanguage, ComparesAndJoinsConditions) {
    EXPECT_EQ(resultOf("result = 1 < 2 and 2 <= 2 and not 3 > 4"), "True");
    EXPECT_EQ(resultOf("result = 1 == 1.0"), "True");
    EXPECT_EQ(resultOf("result = True xor True"), "False");
    EXPECT_EQ(resultOf("result = False or 1 != 2"), "True");
    EXPECT_EQ(resultOf("result = \"a\" == \"a\""), "True");
    EXPECT_EQ(resultOf("result = \"a\" == 1"), "False");
    EXPECT_EQ(resultOf("result = [1, 2] == [1, 2.0]"), "True");
    EXPECT_EQ(resultOf("result = [1, 2] == [1, 2, 3]"), "False");
    EXPECT_EQ(resultOf("result = p[1,2,3,4,5,6] == p[1,2,3,4,5,6]"), "True");
}

TEST(UrscriptLanguage, DoesNotLookAtTheRightSideThatCannotMatter) {
    EXPECT_EQ(resultOf("result = False and 1 / 0 > 1"), "False");
    EXPECT_EQ(resultOf("result = True or 1 / 0 > 1"), "True");
}

TEST(UrscriptLanguage, CalculatesWithListsElementByElement) {
    EXPECT_EQ(resultOf("result = [1, 2, 3] + [10, 20, 30]"), "[11, 22, 33]");
    EXPECT_EQ(resultOf("result = [10, 20, 30] / [1, 2, 4]"), "[10, 10, 7.5]");
    EXPECT_EQ(resultOf("result = 5 * [[1, 2], [3, 4]]"), "[[5, 10], [15, 20]]");
    EXPECT_EQ(resultOf("result = [11, 22, 33] % 5"), "[1, 2, 3]");
    EXPECT_EQ(resultOf("result = -3 * [1, 2]"), "[-3, -6]");
    EXPECT_EQ(resultOf("result = -[1, 2]"), "[-1, -2]");
    EXPECT_EQ(resultOf("result = 10 / [1, 2]"), "[10, 5]");
}

TEST(UrscriptLanguage, MultipliesMatrices) {
    EXPECT_EQ(resultOf("result = [[1,2],[3,4],[5,6]] * [[10,20,30],[40,50,60]]"),
              "[[90, 120, 150], [190, 260, 330], [290, 400, 510]]");
    EXPECT_EQ(resultOf("result = [[1,2],[3,4],[5,6]] * [10,20]"), "[50, 110, 170]");
    EXPECT_THAT(resultOf("result = [[1,2],[3,4]] * [1,2,3]"), HasSubstr("2 columns"));
    EXPECT_THAT(resultOf("result = [[1],[2]] * [[1,2],[3]]"), HasSubstr("1 columns"));
}

TEST(UrscriptLanguage, ReadsAndWritesElements) {
    EXPECT_EQ(resultOf("a = [1, [2, 3]]\na[0] = 5\na[1][1] = 7\nresult = a"), "[5, [2, 7]]");
    EXPECT_EQ(resultOf("m = [[1, 2], [3, 4]]\nm[1, 0] = 9\nresult = m[1, 0] + m[0][1]"), "11");
    EXPECT_EQ(resultOf("a = p[1, 2, 3, 4, 5, 6]\na[2] = 0.5\nresult = a"), "p[1, 2, 0.5, 4, 5, 6]");
    EXPECT_EQ(resultOf("p = [7, 8]\nresult = p[1]"), "8");
    EXPECT_EQ(resultOf("p = [7, 8]\ni = 0\nresult = p[i + 1]"), "8");
    EXPECT_EQ(resultOf("p = [7, 8]\nresult = [p[1], p[0], norm(p[0])]"), "[8, 7, 7]");
    EXPECT_EQ(resultOf("p = [[7, 8], [9, 10]]\nresult = p[1, 0]"), "9");
    EXPECT_EQ(resultOf("p = 5\nresult = p[p, 0, (1), 0, [2, 3][0], -p]"), "p[5, 0, 1, 0, 2, -5]");
    EXPECT_EQ(resultOf("result = [1, 2, 3][1]"), "2");
}

TEST(UrscriptLanguage, CopiesListsThatAreAssigned) {
    EXPECT_EQ(resultOf("a = [1, 2]\nb = a\nb[0] = 9\nresult = a"), "[1, 2]");
    EXPECT_EQ(resultOf("def f(l):\n l[0] = 9\n return l\nend\na = [1]\nf(a)\nresult = a"), "[1]");
}

TEST(UrscriptLanguage, CalculatesWithPosesComponentByComponent) {
    EXPECT_EQ(resultOf("result = p[1,2,3,4,5,6] * 2"), "p[2, 4, 6, 8, 10, 12]");
    EXPECT_EQ(resultOf("result = p[1,2,3,4,5,6] + p[1,1,1,1,1,1]"), "p[2, 3, 4, 5, 6, 7]");
    EXPECT_THAT(resultOf("result = p[1,2,3,4,5,6] + 1"), HasSubstr("pose + int is not possible"));
}

TEST(UrscriptLanguage, RunsBranchesAndLoops) {
    const std::string choose =
        "def f(x):\n  if x < 0:\n    return \"low\"\n  elif x == 0:\n    return \"zero\"\n"
        "  else:\n    return \"high\"\n  end\nend\n";
    EXPECT_EQ(resultOf(choose + "result = f(-1)"), "low");
    EXPECT_EQ(resultOf(choose + "result = f(0)"), "zero");
    EXPECT_EQ(resultOf(choose + "result = f(3)"), "high");
    EXPECT_EQ(resultOf("i = 0\nresult = 0\nwhile True:\n  i = i + 1\n  if i == 3:\n    continue\n"
                       "  end\n  if i > 5:\n    break\n  end\n  result = result + i\nend"),
              "12");
    EXPECT_EQ(resultOf("if 2: result = 1 end"), "1");
    EXPECT_EQ(resultOf("result = 0\nif \"\":\nresult = 1\nend"), "0");
}

TEST(UrscriptLanguage, GoesOnInTheNextLineWithinBracketsAndBehindOperators) {
    EXPECT_EQ(resultOf("result = str_cat(\n  \"a\",  # first\n  \"b\")"), "ab");
    EXPECT_EQ(resultOf("result = 1 == 2 or\n  2 == 2 or\n  False"), "True");
    EXPECT_EQ(resultOf("result = [1,\n2]"), "[1, 2]");
}

TEST(UrscriptLanguage, CallsFunctionsWithDefaultsAndNames) {
    const std::string function = "def f(a, b=2, c=[1, -1]):\n  return [a, b, c[0]]\nend\n";
    EXPECT_EQ(resultOf(function + "result = f(1)"), "[1, 2, 1]");
    EXPECT_EQ(resultOf(function + "result = f(1, c = [5])"), "[1, 2, 5]");
    EXPECT_EQ(resultOf(function + "result = f(b = 3, a = 4)"), "[4, 3, 1]");
    EXPECT_EQ(resultOf("result = g(2)\ndef g(x):\n  return x * 2\nend"), "4");
    EXPECT_EQ(resultOf("def f(n):\nif n < 2:\nreturn 1\nend\nreturn n * f(n - 1)\nend\n"
                       "result = f(6)"),
              "720");
}

TEST(UrscriptLanguage, TakesADefaultFromAGlobalVariable) {
    EXPECT_EQ(resultOf("k = 3\ndef f(a=k):\nreturn a\nend\nk = 4\nresult = f()"), "4");
}

// The examples of the manual's chapter on scoping.
TEST(UrscriptLanguage, BindsNamesAsTheManualSays) {
    EXPECT_EQ(resultOf("global result = 0\ndef f():\nlocal result = 1\nend\nf()"), "0");
    EXPECT_EQ(resultOf("global result = 0\ndef f():\nresult = 1\nend\nf()"), "1");
    EXPECT_EQ(resultOf("result = 0\ndef f():\nresult = 1\nend\nf()"), "1");
    EXPECT_EQ(resultOf("local result = 0\ndef f():\nresult = 1\nend\nf()"), "1");
    EXPECT_EQ(resultOf("global result = 0\ndef f():\nlocal result = 1\ndef g():\nresult = 2\nend\n"
                       "g()\nend\nf()"),
              "2");
    EXPECT_EQ(resultOf("def f():\nglobal result = 5\nend\nf()"), "5");
    // A variable that was not global before is local to the function.
    EXPECT_EQ(resultOf("def f():\nx = 1\nreturn x\nend\nx = 7\nf()\nresult = x"), "7");
}

TEST(UrscriptLanguage, ReadsAGlobalVariableThatIsAssignedFurtherDown) {
    EXPECT_EQ(resultOf("def f():\nreturn limit + 1\nend\nlimit = 4\nresult = f()"), "5");
}

TEST(UrscriptLanguage, AVariableMayHaveTheNameOfAFunction) {
    EXPECT_EQ(resultOf("def f(time, list):\nlocal length = get_list_length(list)\n"
                       "return time + length\nend\nresult = f(1, [5, 6])"),
              "3");
}

TEST(UrscriptLanguage, TellsNameAndKindOfAProgram) {
    EXPECT_EQ(parsed("def moveAround():\nend\n").name(), "moveAround");
    EXPECT_EQ(parsed("def a():\nend").kind(), ProgramKind::primary);
    EXPECT_EQ(parsed("# c\n\nsec quick():\n set_digital_out(1, True)\nend\n").kind(),
              ProgramKind::secondary);
    EXPECT_EQ(parsed("stopj(2)\n").name(), "");
    EXPECT_EQ(parsed("").kind(), ProgramKind::primary);
}

TEST(UrscriptLanguage, ASingleLineIsAProgram) {
    FakeRobot robot;
    Interpreter interpreter(parsed("set_digital_out(1,True)\n"), robot);
    EXPECT_EQ(interpreter.step(), RunState::finished);
    EXPECT_TRUE((robot.outputs[{DigitalPort::standard, 1}]));
}

TEST(UrscriptParse, TellsWhereAndWhy) {
    EXPECT_EQ(parseError("def a():\n  x = 1 +\nend\n"),
              "line 3, column 1: a value is missing before 'end'");
    EXPECT_EQ(parseError("def a():\n  x = \n"), "line 3, column 1: a value is missing");
    EXPECT_EQ(parseError("def a():\n  if True:\n  x = 1\nend\n"),
              "line 5, column 1: 'end' of the program is missing");
    EXPECT_EQ(parseError("def a():\nend\nend\n"),
              "line 3, column 1: the end of the text is missing before 'end'");
    EXPECT_EQ(parseError("x = \"abc\n"), "line 1, column 5: the string has no end");
    EXPECT_EQ(parseError("x = 1 2\n"),
              "line 1, column 7: the end of the line is missing before '2'");
    EXPECT_EQ(parseError("x = 1 ? 2"), "line 1, column 7: a character that has no meaning here");
    EXPECT_EQ(parseError("x"), "line 1, column 2: '=' or '(' is missing");
    EXPECT_EQ(parseError("break"), "line 1, column 1: 'break' outside of a loop");
    EXPECT_EQ(parseError("x = p[1,2]"), "line 1, column 5: a pose has 6 numbers, not 2");
    EXPECT_EQ(parseError("x = 12abc"),
              "line 1, column 5: a number and a name need a blank between them");
}

TEST(UrscriptParse, RefusesNamesThatNobodyDefines) {
    EXPECT_EQ(parseError("def a():\n  foo(1)\nend"),
              "line 2, column 3: function 'foo' is not defined");
    EXPECT_EQ(parseError("def a():\n  x = y + 1\nend"),
              "line 2, column 7: variable 'y' is not defined");
    EXPECT_EQ(parseError("run foo()"), "line 1, column 1: thread 'foo' is not defined");
    for (const auto* text : {"foo(1)", "x = y", "run foo()"}) {
        EXPECT_EQ(Program::parse(text).error().code, Errc::not_found) << text;
    }
    EXPECT_EQ(Program::parse("x = (").error().code, Errc::invalid_argument);
    EXPECT_EQ(parseError("def a():\nthread t():\nend\nt()\nend"),
              "line 4, column 1: thread 't' has to be started by run");
    EXPECT_EQ(parseError("def a():\ndef f():\nend\ndef f():\nend\nend"),
              "line 4, column 1: 'f' is defined twice");
}

TEST(UrscriptParse, RefusesWrongArguments) {
    EXPECT_EQ(parseError("sleep()"), "line 1, column 1: sleep needs an argument for 't'");
    EXPECT_EQ(parseError("sync(1)"), "line 1, column 6: sync takes at most 0 arguments");
    EXPECT_EQ(parseError("popup(\"a\", color=1)"),
              "line 1, column 12: popup has no parameter 'color'");
    EXPECT_EQ(parseError("sleep(1, t=2)"), "line 1, column 10: sleep gets parameter 't' twice");
    EXPECT_EQ(parseError("popup(s=\"a\", 1)"),
              "line 1, column 14: an argument's name is missing before '1'");
    EXPECT_EQ(parseError("def a():\ndef f(x, y=1):\nend\nf(y=2)\nend"),
              "line 4, column 1: f needs an argument for 'x'");
}

TEST(UrscriptParse, BoundsNestingAndSize) {
    const std::string deep = "x = " + std::string(5000, '(') + "1" + std::string(5000, ')');
    EXPECT_THAT(parseError(deep), HasSubstr("more than 100 levels"));
    EXPECT_THAT(parseError("x = " + std::string(5000, '-') + "1"), HasSubstr("more than 100"));
    std::string blocks;
    for (int i = 0; i < 500; ++i) {
        blocks += "if True:\n";
    }
    EXPECT_THAT(parseError(blocks), HasSubstr("more than 100 levels"));
    EXPECT_THAT(parseError(std::string(Program::kMaxText + 1, ' ')), HasSubstr("1000000"));
    std::string sum = "x = 1";
    for (int i = 0; i < 50'000; ++i) {
        sum += "+1";
    }
    EXPECT_EQ(parseError(sum), "");
}

TEST(UrscriptException, TellsLineColumnAndReason) {
    EXPECT_EQ(resultOf("a = [1, 2]\nresult = a[2]"), "3:11 index 2 is out of range: 2 elements");
    EXPECT_EQ(resultOf("result = 1 / 0"), "2:12 division by zero");
    EXPECT_EQ(resultOf("result = 1 + \"a\""), "2:12 int + string is not possible");
    EXPECT_EQ(resultOf("result = [1, 2] + [1]"), "2:17 list of 2 + list of 1: the lengths differ");
    EXPECT_EQ(resultOf("x = 5\nx[0] = 1"), "3:1 int has no elements");
    EXPECT_EQ(resultOf("if [1]:\nend"), "2:4 a condition has to be a bool, not list");
    EXPECT_EQ(resultOf("result = result + 1"), "2:10 variable 'result' has no value");
    EXPECT_EQ(resultOf("movej([1, 2])"),
              "2:1 movej: argument q has to be a list of 6 numbers, not list of 2");
    EXPECT_EQ(resultOf("set_tcp(5)"), "2:1 set_tcp: argument pose has to be a pose, not int");
    EXPECT_EQ(resultOf("result = not \"a\" + 1"), "2:18 string + int is not possible");
    EXPECT_EQ(resultOf("result = p[1, 2, True, 4, 5, 6]"),
              "2:10 an element of a pose has to be a number, not bool");
    EXPECT_EQ(resultOf("read_input_integer_register(99)"), "2:1 no register 99");
}

TEST(UrscriptException, EndlessRecursionIsAnException) {
    EXPECT_EQ(resultOf("def f():\nreturn f()\nend\nresult = f()"),
              "3:8 more than 200 calls within each other");
}

TEST(UrscriptException, ListsAndTextsThatGrowWithoutEndAreAnException) {
    EXPECT_THAT(resultOf("a = [0]\nwhile True:\na = [a, a]\nend"),
                HasSubstr("more than 8 lists in lists"));
    EXPECT_THAT(resultOf("a = \"ab\"\nwhile True:\na = str_cat(a, a)\nend"),
                HasSubstr("more than 100000 characters"));
    EXPECT_THAT(resultOf("a = [0]\nwhile True:\na[0] = a\nend"), HasSubstr("lists in lists"));
    EXPECT_THAT(resultOf("a = make_list(100000, 0)\nresult = [a, a]"),
                HasSubstr("more than 100000 values"));
    EXPECT_THAT(resultOf("a = make_list(100001, 0)"), StartsWith("2:5 make_list: the length"));
}

}  // namespace
}  // namespace metier::urscript
