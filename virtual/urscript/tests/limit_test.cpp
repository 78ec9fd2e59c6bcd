#include <gmock/gmock.h>

#include "fake_robot.hpp"

namespace metier::urscript {
namespace {

using testing::HasSubstr;

/// As resultOf(), within other limits than the controller's.
std::string resultWithin(RunLimits limits, std::string_view statements) {
    FakeRobot robot;
    Interpreter interpreter(parsed(within(statements)), robot, limits);
    for (int i = 0; i < 100 && interpreter.step() == RunState::running; ++i) {
    }
    if (const auto& exception = interpreter.exception()) {
        return exception->text;
    }
    const auto result = interpreter.variable("result");
    return result ? result->text() : "no result";
}

TEST(UrscriptLimit, CallsWithinEachOther) {
    RunLimits limits;
    limits.call_depth = 3;  // the program itself is the first
    const std::string down = "def f(n):\nif n > 0:\nreturn f(n - 1)\nend\nreturn 7\nend\n";
    EXPECT_EQ(resultWithin(limits, down + "result = f(1)"), "7");
    EXPECT_EQ(resultWithin(limits, down + "result = f(2)"), "more than 3 calls within each other");
    EXPECT_EQ(resultWithin(limits, down + "i = 0\nwhile i < 50:\ni = i + 1\nresult = f(1)\nend"),
              "7");  // calls one after the other are not within each other
}

TEST(UrscriptLimit, ThreadsAtATime) {
    RunLimits limits;
    limits.threads = 2;  // the main thread is the first
    const std::string thread = "thread t():\nsync()\nend\n";
    EXPECT_EQ(resultWithin(limits, thread + "i = 0\nwhile i < 5:\nh = run t()\njoin h\ni = i + 1\n"
                                            "end\nresult = i"),
              "5");
    EXPECT_EQ(resultWithin(limits, thread + "run t()\nrun t()"), "more than 2 threads");
}

TEST(UrscriptLimit, ValuesOfAListAndOfTheListsInIt) {
    RunLimits limits;
    limits.list_length = 10;
    EXPECT_EQ(resultWithin(limits, "result = length(make_list(10, 0))"), "10");
    EXPECT_EQ(resultWithin(limits, "make_list(11, 0)"),
              "make_list: the length has to be from 0 to 10");
    EXPECT_EQ(resultWithin(limits, "a = [1, 2, 3, 4]\nresult = [a, a]"),
              "[[1, 2, 3, 4], [1, 2, 3, 4]]");
    EXPECT_EQ(resultWithin(limits, "a = [1, 2, 3, 4, 5]\nresult = [a, a]"),
              "a list of more than 10 values");
    EXPECT_EQ(resultWithin(limits, "a = [0, 0, 0, 0, 0, 0]\na[0] = [1, 2, 3, 4]\nresult = a"),
              "[[1, 2, 3, 4], 0, 0, 0, 0, 0]");
    EXPECT_EQ(resultWithin(limits, "a = [0, 0, 0, 0, 0, 0]\na[0] = [1, 2, 3, 4]\na[1] = [5]"),
              "a list of more than 10 values");
    EXPECT_EQ(resultWithin(limits,
                           "a = [0, 0, 0, 0, 0, 0]\na[0] = [1, 2, 3, 4]\na[0] = 1\n"
                           "a[1] = [1, 2, 3, 4]\nresult = a"),
              "[1, [1, 2, 3, 4], 0, 0, 0, 0]");
}

TEST(UrscriptLimit, ListsInLists) {
    EXPECT_EQ(resultOf("result = [[[[[[[[1]]]]]]]]"), "[[[[[[[[1]]]]]]]]");
    EXPECT_EQ(resultOf("result = [[[[[[[[[1]]]]]]]]]"), "2:10 more than 8 lists in lists");
    EXPECT_EQ(resultOf("a = [[[[[[[1]]]]]]]\nb = [0]\nb[0] = a\nresult = b"), "[[[[[[[[1]]]]]]]]");
    EXPECT_EQ(resultOf("a = [[[[[[[[1]]]]]]]]\nb = [0]\nb[0] = a"),
              "4:1 more than 8 lists in lists");
}

RunLimits tenCharacters() {
    RunLimits limits;
    limits.text_length = 10;
    return limits;
}

TEST(UrscriptLimit, CharactersOfAString) {
    EXPECT_EQ(resultWithin(tenCharacters(), "result = \"12345\" + \"67890\""), "1234567890");
    for (const std::string_view grows :
         {"x = \"12345678901\"", "x = \"12345\" + \"678901\"", "x = str_cat(12345, 678901)",
          "x = to_str([1, 2, 3, 4])"}) {
        EXPECT_EQ(resultWithin(tenCharacters(), grows), "a string of more than 10 characters")
            << grows;
    }
}

TEST(UrscriptLimit, CharactersOfTheStringsInAList) {
    constexpr const char* kTooMany = "a list with more than 10 characters";
    EXPECT_EQ(resultWithin(tenCharacters(), "a = [\"12345\"]\nresult = a + a"), "[1234512345]");
    for (const std::string_view grows :
         {"x = [\"12345\", \"678901\"]", "a = [\"12345\"]\na = a + a\na = a + a",
          "a = [\"12345\", [\"\"]]\na[1][0] = \"678901\"", "a = make_list(11, \"x\")",
          "a = make_list(5, \"\")\nb = a + \"123\""}) {
        EXPECT_THAT(resultWithin(tenCharacters(), grows), HasSubstr(kTooMany)) << grows;
    }
    EXPECT_EQ(resultWithin(tenCharacters(),
                           "a = [\"123456\"]\na[0] = \"12345678\"\n"
                           "a[0] = \"1234567890\"\nresult = a"),
              "[1234567890]");  // what was replaced counts no longer
}

TEST(UrscriptLimit, StringsInAListDoNotGrowWithoutEnd) {
    EXPECT_THAT(resultOf("a = [\"ab\"]\ni = 0\nwhile i < 20:\na = a + a\ni = i + 1\nend"),
                HasSubstr("more than 100000 characters"));
    EXPECT_THAT(resultOf("a = make_list(20000, \"0123456789\")"),
                HasSubstr("more than 100000 characters"));
    EXPECT_THAT(resultOf("a = make_list(20000, \"\") + \"0123456789\""),
                HasSubstr("more than 100000 characters"));
}

TEST(UrscriptLimit, InstructionsOfOneCycle) {
    EXPECT_EQ(resultOf("i = 0\nwhile i < 30000:\ni = i + 1\nif i % 4000 == 0:\nsync()\nend\nend\n"
                       "result = i"),
              "30000");
    EXPECT_THAT(resultOf("i = 0\nwhile i < 30000:\ni = i + 1\nend"), HasSubstr("infinite loop"));
}

TEST(UrscriptLimit, LongListsCountAsManyInstructions) {
    const std::string lists = "a = make_list(40000, 0)\nb = make_list(40000, 0)\n";
    EXPECT_EQ(resultOf(lists + "result = a == b"), "True");
    EXPECT_THAT(resultOf(lists + "i = 0\nwhile i < 50:\nsame = a == b\ni = i + 1\nend"),
                HasSubstr("infinite loop"));
    EXPECT_THAT(resultOf(lists + "i = 0\nwhile i < 50:\na[0] = i\ni = i + 1\nend"),
                HasSubstr("infinite loop"));
    EXPECT_EQ(
        resultOf(lists + "i = 0\nwhile i < 2000:\ni = i + length(a) / 40000\nend\nresult = i"),
        "2000");  // asking for a length is quick
}

TEST(UrscriptLimit, AFunctionWithTooManyVariablesInARecursionIsAnException) {
    std::string function = "def f():\n";
    for (int i = 0; i < 500; ++i) {
        function += "x" + std::to_string(i) + " = 1\n";
    }
    EXPECT_THAT(resultOf(function + "return f()\nend\nf()"), HasSubstr("calls within each other"));
}

}  // namespace
}  // namespace metier::urscript
