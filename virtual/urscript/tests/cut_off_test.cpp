// Programs that are incomplete or have something too many.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>

#include "fake_robot.hpp"
#include "metier/base/text.hpp"

namespace metier::urscript {
namespace {

using testing::HasSubstr;
using testing::MatchesRegex;

constexpr std::string_view kWhole = R"(def whole():
  global total = 0
  local items = [1, [2, 3]]
  def f(x, y=2):
    if x > y and not x == 7:
      return x
    elif x == y:
      pass
    else:
      x = -x
    end
    return [x, p[0, 0, 0, 0, 0, y]]
  end
  thread t():
    while True:
      total = total + 1
      if total > 3:
        break
      end
      sync()
    end
  end
  h = run t()
  enter_critical
  items[1][0] = f(y = 1, x = 0 / 5)
  exit_critical
  kill h
  join h
  halt
end)";

int lineOf(const std::string& error) {
    return std::stoi(error.substr(std::string_view("line ").size()));
}

TEST(UrscriptCutOff, AProgramIsRefusedWhereverItIsCut) {
    ASSERT_EQ(parseError(kWhole), "");
    for (std::size_t length = 1; length < kWhole.size(); ++length) {
        const std::string_view part = kWhole.substr(0, length);
        const auto program = Program::parse(part);
        ASSERT_FALSE(program) << part;
        EXPECT_EQ(program.error().code, Errc::invalid_argument) << part;
        ASSERT_THAT(program.error().message, MatchesRegex("line [0-9]+, column [0-9]+: .+"));
        EXPECT_LE(lineOf(program.error().message), 1 + std::count(part.begin(), part.end(), '\n'));
    }
}

TEST(UrscriptCutOff, AProgramIsRefusedIfABeginOrAnEndIsMissing) {
    const auto lines = split(kWhole, '\n');
    for (std::size_t missing = 0; missing < lines.size(); ++missing) {
        const std::string_view line = trimmed(lines[missing]);
        const bool block = line == "end" || line.starts_with("def") || line.starts_with("if") ||
                           line.starts_with("while") || line.starts_with("thread");
        auto rest = lines;
        rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(missing));
        if (block) {
            EXPECT_THAT(parseError(fmt::format("{}\n", fmt::join(rest, "\n"))),
                        MatchesRegex("line [0-9]+, column [0-9]+: .+"))
                << "without line " << missing + 1;
        }
    }
}

struct Slip {
    const char* text;
    const char* error;
};

class UrscriptSlip : public testing::TestWithParam<Slip> {};

TEST_P(UrscriptSlip, IsReportedWithItsPlace) {
    EXPECT_EQ(parseError(GetParam().text), GetParam().error) << GetParam().text;
}

constexpr Slip kSlips[] = {
    {"def", "line 1, column 4: the program's name is missing"},
    {"def a", "line 1, column 6: '(' is missing"},
    {"def a(x):\nend", "line 1, column 7: ')' is missing before 'x'"},
    {"def a()\nend", "line 1, column 8: ':' is missing"},
    {"sec s():\nend\nstopj(2)", "line 3, column 1: the end of the text is missing before 'stopj'"},
    {"if True\nend", "line 1, column 8: ':' is missing"},
    {"while True:\n", "line 2, column 1: 'end' of 'while' is missing"},
    {"if True:\nelse:\nelif True:\nend",
     "line 3, column 1: 'end' of 'if' is missing before 'elif'"},
    {"else:\nend", "line 1, column 1: the end of the text is missing before 'else'"},
    {"thread t(x):\nend", "line 1, column 10: a thread has no parameters"},
    {"run", "line 1, column 4: a thread's name is missing"},
    {"run t(1)", "line 1, column 7: ')' is missing before '1'"},
    {"kill", "line 1, column 5: a value is missing"},
    {"enter_critical(", "line 1, column 16: ')' is missing"},
    {"x = [1, 2", "line 1, column 10: ',' or ']' is missing"},
    {"x = p[1, 2, 3, 4, 5, 6, 7]", "line 1, column 25: more than 6 values"},
    {"sleep(1 2)", "line 1, column 9: ',' or ')' is missing before '2'"},
    {"x = sleep(", "line 1, column 11: a value is missing"},
    {"global 5", "line 1, column 8: a variable's name is missing before '5'"},
    {"return = 5", "line 1, column 8: a value is missing before '='"},
    {"end = 5", "line 1, column 1: the end of the text is missing before 'end'"},
    {"continue", "line 1, column 1: 'continue' outside of a loop"},
    {"while True:\ndef f():\nbreak\nend\nend", "line 3, column 1: 'break' outside of a loop"},
    {"x = True = 5", "line 1, column 10: the end of the line is missing before '='"},
    {"5 = x", "line 1, column 1: a statement is missing before '5'"},
    {"x = \"a\nb\"", "line 1, column 5: the string has no end"},
    {"x = 'a'", "line 1, column 5: a character that has no meaning here"},
    {"# one\n\n\tx = {1}", "line 3, column 6: a character that has no meaning here"},
};

INSTANTIATE_TEST_SUITE_P(All, UrscriptSlip, testing::ValuesIn(kSlips));

TEST(UrscriptParse, RefusesByNameWhatTheInterpreterDoesNotHave) {
    for (const std::string_view name :
         {"set_flag", "get_flag", "transpose", "struct", "set_conveyor_tick_count",
          "path_offset_enable", "modbus_add_signal", "rpc_factory", "interpreter_mode",
          "request_boolean_from_primary_client"}) {
        EXPECT_EQ(parseError(fmt::format("x = 1\ny = {}(x)\n", name)),
                  fmt::format("line 2, column 5: function '{}' is not defined", name));
    }
    EXPECT_EQ(parseError("a = [1]\na.append(2)"),
              "line 2, column 2: '=' or '(' is missing before '.'");
    EXPECT_EQ(parseError("switch 1:\nend"), "line 1, column 8: '=' or '(' is missing before '1'");
}

TEST(UrscriptParse, ShowsOnlyTheBeginOfAVeryLongWord) {
    EXPECT_EQ(
        parseError("x = 1 " + std::string(1000, 'a')),
        "line 1, column 7: the end of the line is missing before '" + std::string(40, 'a') + "'");
}

/// `count` texts in which {} is the number, separated by commas.
std::string series(std::string_view form, int count) {
    std::string text;
    for (int i = 0; i < count; ++i) {
        text += (i == 0 ? "" : ", ") + fmt::format(fmt::runtime(form), i);
    }
    return text;
}

TEST(UrscriptParse, AFunctionHasAtMostSixtyFourParametersAndArguments) {
    const auto called = [](int parameters, int arguments) {
        return within("def f(" + series("x{}", parameters) + "):\nreturn x0 + x" +
                      std::to_string(parameters - 1) + "\nend\nresult = f(" +
                      series("{}", arguments) + ")");
    };
    EXPECT_EQ(parseError(called(64, 64)), "");
    EXPECT_THAT(parseError(called(65, 65)),
                HasSubstr("line 2, column 317: more than 64 parameters"));
    EXPECT_THAT(parseError(called(64, 65)), HasSubstr(": more than 64 arguments"));
}

TEST(UrscriptParse, AListThatIsWrittenDownHasAtMostAThousandValues) {
    EXPECT_EQ(resultOf("result = length([" + series("{}", 1000) + "])"), "1000");
    EXPECT_THAT(parseError("x = [" + series("{}", 1001) + "]"), HasSubstr("more than 1000 values"));
}

TEST(UrscriptParse, ATextMayHaveAMillionBytes) {
    const std::string statement = "textmsg(1)\n";
    const std::string text = statement + std::string(Program::kMaxText - statement.size(), ' ');
    EXPECT_EQ(parseError(text), "");
    EXPECT_EQ(parseError(text + " "),
              "line 1, column 1: the script has 1000001 bytes, more than 1000000");
}

TEST(UrscriptParse, BytesThatAreNoScriptAreRefusedWithTheirPlace) {
    EXPECT_EQ(parseError(std::string_view("x = 1\n\0", 7)),
              "line 2, column 1: a character that has no meaning here");
    EXPECT_EQ(parseError("textmsg(\"\xc3\xa4\")"), "");  // but any in a string
    EXPECT_EQ(parseError("x\xc3\xa4 = 1"),
              "line 1, column 2: a character that has no meaning here");
}

}  // namespace
}  // namespace metier::urscript
