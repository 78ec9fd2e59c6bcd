#include "metier/cell/toml_file.hpp"

#include <gmock/gmock.h>

namespace metier::cell {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TomlFile parsed(std::string_view text) {
    return std::move(TomlFile::parse(text, "a.toml").value());
}

TEST(TomlFile, ReadsValuesOfEachType) {
    const auto file = parsed(R"(
name = "ur5"
cycle = 0.008
axes = 6
loud = true
limits = [1.0, 2]
tools = ["flange"]
[frame]
x = 1
)");
    const auto root = file.root();
    EXPECT_EQ(root.text("name"), "ur5");
    EXPECT_DOUBLE_EQ(root.number("cycle"), 0.008);
    EXPECT_EQ(root.integerOr("axes", 0, 1, 7), 6);
    EXPECT_TRUE(root.flagOr("loud", false));
    EXPECT_THAT(root.numbers("limits"), ElementsAre(1.0, 2.0));
    EXPECT_THAT(root.texts("tools"), ElementsAre("flange"));
    EXPECT_DOUBLE_EQ(root.table("frame").number("x"), 1.0);
    EXPECT_TRUE(file.finish());
}

TEST(TomlFile, TakesNoFractionForAWholeNumber) {
    for (const auto* number : {"70000.0", "48e40", "nan"}) {
        const auto file = parsed(std::string("port = ") + number + "\n");
        EXPECT_EQ(file.root().integerOr("port", 7, 0, 65535), 7) << number;
        const auto finished = file.finish();
        ASSERT_FALSE(finished) << number;
        EXPECT_THAT(finished.error().message, HasSubstr("a.toml:1: port: is not a whole number"));
    }
}

TEST(TomlFile, NamesFileLineAndColumnOfASyntaxError) {
    const auto file = TomlFile::parse("name = \n", "a.toml");
    ASSERT_FALSE(file);
    EXPECT_EQ(file.error().code, Errc::invalid_argument);
    EXPECT_THAT(file.error().message, HasSubstr("a.toml:1:"));
}

TEST(TomlFile, NamesLineAndKeyOfEverythingWrong) {
    const auto file = parsed("name = 3\n\n[frame]\nx = \"wide\"\n");
    const auto root = file.root();
    root.text("name");
    root.table("frame").number("x");
    root.number("cycle");
    const auto outcome = file.finish();
    ASSERT_FALSE(outcome);
    EXPECT_THAT(outcome.error().message, HasSubstr("a.toml:1: name: is not a text"));
    EXPECT_THAT(outcome.error().message, HasSubstr("a.toml:4: frame.x: is not a finite number"));
    EXPECT_THAT(outcome.error().message, HasSubstr("cycle: missing"));
}

TEST(TomlFile, RefusesAKeyThatNobodyKnows) {
    const auto file = parsed("name = \"a\"\nnmae = \"b\"\n");
    file.root().text("name");
    const auto outcome = file.finish();
    ASSERT_FALSE(outcome);
    EXPECT_EQ(outcome.error().message, "a.toml:2: nmae: unknown key; known here: name");
}

TEST(TomlFile, RefusesNumbersThatAreNotFiniteOrOutOfRange) {
    const auto file = parsed("a = nan\nb = [inf]\nc = 9\n");
    const auto root = file.root();
    root.number("a");
    root.numbers("b");
    EXPECT_EQ(root.integerOr("c", 1, 0, 5), 1);
    const auto outcome = file.finish();
    ASSERT_FALSE(outcome);
    EXPECT_THAT(outcome.error().message, HasSubstr("a.toml:1: a:"));
    EXPECT_THAT(outcome.error().message, HasSubstr("a.toml:2: b:"));
    EXPECT_THAT(outcome.error().message, HasSubstr("a.toml:3: c: 9 is not within 0 to 5"));
}

TEST(TomlFile, TellsThatAFileIsMissing) {
    const auto file = TomlFile::load("/nonexistent/a.toml");
    ASSERT_FALSE(file);
    EXPECT_EQ(file.error().code, Errc::not_found);
}

TEST(TomlFile, GivesValuesOfAnyKindAsTheFileHasThem) {
    const auto file = parsed("a = [1, { b = 'c' }, true]\n");
    const auto list = file.root().value("a");
    ASSERT_TRUE(list && list->isList());
    const auto items = list->items();
    ASSERT_EQ(items.size(), 3U);
    EXPECT_EQ(items[0].integer(), 1);
    EXPECT_EQ(items[0].number(), 1.0);
    EXPECT_FALSE(items[0].flag());
    EXPECT_EQ(items[1].table()->text("b"), "c");
    EXPECT_EQ(items[2].flag(), true);
    EXPECT_FALSE(items[2].number());
    EXPECT_FALSE(file.root().value("z"));
}

TEST(TomlFile, TellsAllKeysInTheOrderOfTheFile) {
    const auto file = parsed("[t]\nz = 1\na = 2\nm = 3\n");
    EXPECT_THAT(file.root().table("t").keys(), ElementsAre("z", "a", "m"));
    EXPECT_FALSE(file.finish()) << "telling a key is no asking for it";
}

TEST(TomlFile, RemembersWhatWasAskedForHoweverOftenATableIsOpened) {
    const auto file = parsed("[t]\nx = 1\n");
    EXPECT_TRUE(file.root().value("t")->table());
    EXPECT_DOUBLE_EQ(file.root().table("t").number("x"), 1.0);
    EXPECT_TRUE(file.finish());
}

TEST(TomlFile, SortsWhatItsReaderNotesAmongItsOwn) {
    const auto file = parsed("x = 1\ny = [inf]\n");
    file.root().value("y")->items().front().reject("is not finite");
    file.note(1, "x", "is one too many");
    const auto finished = file.finish();
    ASSERT_FALSE(finished);
    EXPECT_EQ(finished.error().message.find("a.toml:1: x: is one too many"), 0U);
    EXPECT_THAT(finished.error().message, HasSubstr("a.toml:2: y[0]: is not finite"));
}

TEST(TomlFile, RefusesALineThatIsTooLongForAnybodyToHaveWritten) {
    std::string deep = "x = 1\ny";
    for (int level = 0; level < 400'000; ++level) {
        deep += ".y";
    }
    const auto file = TomlFile::parse(deep + " = 1\n", "a.toml");
    ASSERT_FALSE(file);
    EXPECT_EQ(file.error().message, "a.toml:2: the line has 800005 characters, limit 20000");
}

}  // namespace
}  // namespace metier::cell
