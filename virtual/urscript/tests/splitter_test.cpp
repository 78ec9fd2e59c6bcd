#include <gmock/gmock.h>

#include "metier/urscript/program.hpp"
#include "metier/urscript/script_splitter.hpp"

namespace metier::urscript {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

std::vector<std::string> splitUp(std::string_view text) {
    ScriptSplitter splitter;
    std::vector<std::string> programs;
    EXPECT_TRUE(splitter.push(text, programs));
    return programs;
}

TEST(ScriptSplitter, EachLineOutsideOfAProgramIsOne) {
    EXPECT_THAT(splitUp("stopj(2)\r\n\n# nothing\nset_digital_out(1,True)\n"),
                ElementsAre("stopj(2)\r\n", "set_digital_out(1,True)\n"));
}

TEST(ScriptSplitter, AProgramEndsWithItsEnd) {
    const std::string program =
        "def a():\n  while True: # end\n    if x == \"end\":\n      halt\n    end\n  end\n"
        "\n  thread t():\n  end\nend\n";
    EXPECT_THAT(splitUp(program + "sec b():\nend\nstopj(1)\n"),
                ElementsAre(program, "sec b():\nend\n", "stopj(1)\n"));
}

TEST(ScriptSplitter, AProgramMayComeInAnyPieces) {
    ScriptSplitter splitter;
    std::vector<std::string> programs;
    for (const char c : std::string("def a():\nif True: sync() end\nend\n")) {
        EXPECT_THAT(programs, IsEmpty());
        EXPECT_TRUE(splitter.push(std::string(1, c), programs));
    }
    EXPECT_THAT(programs, ElementsAre("def a():\nif True: sync() end\nend\n"));
}

TEST(ScriptSplitter, DropsWhatGrowsWithoutEnd) {
    ScriptSplitter splitter;
    std::vector<std::string> programs;
    ASSERT_TRUE(splitter.push("def a():\n", programs));
    const auto pushed = splitter.push(std::string(Program::kMaxText, 'x'), programs);
    ASSERT_FALSE(pushed);
    EXPECT_EQ(pushed.error().code, Errc::out_of_range);
    ASSERT_TRUE(splitter.push("\nstopj(2)\n", programs));
    EXPECT_THAT(programs, testing::Contains("stopj(2)\n"));
}

TEST(ScriptSplitter, DropsTheRestOfALineThatIsTooLong) {
    ScriptSplitter splitter;
    std::vector<std::string> programs;
    EXPECT_FALSE(splitter.push(std::string(Program::kMaxText + 1, 'x'), programs));
    EXPECT_TRUE(splitter.push("halt", programs));
    EXPECT_TRUE(splitter.push("\nstopj(2)\n", programs));
    EXPECT_THAT(programs, ElementsAre("stopj(2)\n"));
}

TEST(ScriptSplitter, KeepsTheLinesBehindOneThatIsTooLong) {
    ScriptSplitter splitter;
    std::vector<std::string> programs;
    const std::string line(Program::kMaxText + 5, 'x');
    EXPECT_FALSE(splitter.push("stopj(1)\n" + line + "\nstopj(2)\nstopj", programs));
    EXPECT_TRUE(splitter.push("(3)\n", programs));
    EXPECT_THAT(programs, ElementsAre("stopj(1)\n", "stopj(2)\n", "stopj(3)\n"));
}

TEST(ScriptSplitter, TakesAProgramOfTheGreatestLength) {
    const std::string end = "\nend\n";
    std::string program = "def a():\n#";
    program += std::string(Program::kMaxText - program.size() - end.size(), 'x') + end;
    EXPECT_THAT(splitUp(program), ElementsAre(program));
}

TEST(ScriptSplitter, WordsWithinNamesStringsAndCommentsOpenNoBlock) {
    EXPECT_THAT(splitUp("end_force_mode()\ndefinition = 1 # def\ntextmsg(\"if while\")\n"),
                SizeIs(3));
    EXPECT_THAT(splitUp("if True: stopj(2) end\nstopj(3)\n"), SizeIs(2));
    EXPECT_THAT(splitUp("def a():\n# end\ntextmsg(\"end\")\nx = endless\n"), IsEmpty());
}

TEST(ScriptSplitter, ALineIsNoProgramBeforeItsLineFeed) {
    EXPECT_THAT(splitUp("def a():\nend"), IsEmpty());
    EXPECT_THAT(splitUp("stopj(2)"), IsEmpty());
}

TEST(ScriptSplitter, AnEndTooManyIsALineOfItsOwn) {
    EXPECT_THAT(splitUp("end\nstopj(2)\n"), SizeIs(2));
}

}  // namespace
}  // namespace metier::urscript
