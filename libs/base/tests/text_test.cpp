#include "metier/base/text.hpp"

#include <gmock/gmock.h>

namespace metier {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(Trimmed, RemovesBlanksAtBothEndsAlone) {
    EXPECT_EQ(trimmed(" \t a b\r\n\v\f"), "a b");
    EXPECT_EQ(trimmed("a"), "a");
    EXPECT_EQ(trimmed(" \n "), "");
    EXPECT_EQ(trimmed(""), "");
    EXPECT_EQ(trimmed(" \ta\n", " "), "\ta\n") << "given blanks replace the usual ones";
}

TEST(Split, KeepsEmptyParts) {
    EXPECT_THAT(split("a,b", ','), ElementsAre("a", "b"));
    EXPECT_THAT(split(",a,,b,", ','), ElementsAre("", "a", "", "b", ""));
    EXPECT_THAT(split("a b", ','), ElementsAre("a b"));
    EXPECT_THAT(split(",", ','), ElementsAre("", ""));
    EXPECT_THAT(split("", ','), IsEmpty());
}

TEST(LetterCase, ChangesAsciiLettersAlone) {
    EXPECT_EQ(inLowerCase("AMZamz[@0\xC3\x84"), "amzamz[@0\xC3\x84");
    EXPECT_EQ(inUpperCase("AMZamz{`0\xC3\xA4"), "AMZAMZ{`0\xC3\xA4");
}

TEST(NumberIn, TakesAWholeTextThatIsANumber) {
    EXPECT_EQ(numberIn<int>("-12"), -12);
    EXPECT_EQ(numberIn<double>("1.5e3"), 1500.0);
    EXPECT_FALSE(numberIn<int>(""));
    EXPECT_FALSE(numberIn<int>(" 1"));
    EXPECT_FALSE(numberIn<int>("+1"));
    EXPECT_FALSE(numberIn<int>("1 "));
    EXPECT_FALSE(numberIn<int>("1.5"));
    EXPECT_FALSE(numberIn<unsigned>("-1"));
    EXPECT_FALSE(numberIn<std::uint16_t>("65536"));
}

TEST(Utf8, RefusesOverlongFormsSurrogatesAndCutSequences) {
    EXPECT_TRUE(isUtf8(""));
    EXPECT_TRUE(isUtf8("a\xC3\xA4\xE2\x82\xAC\xF0\x9F\xA4\x96"));
    EXPECT_TRUE(
        isUtf8("\x7F\xC2\x80\xDF\xBF\xE0\xA0\x80\xEF\xBF\xBF\xF0\x90\x80\x80\xF4\x8F\xBF\xBF"));
    EXPECT_TRUE(isUtf8("\xED\x9F\xBF\xEE\x80\x80"));
    EXPECT_FALSE(isUtf8("\xC0\x80")) << "overlong NUL";
    EXPECT_FALSE(isUtf8("\xC1\xBF"));
    EXPECT_FALSE(isUtf8("\xE0\x9F\xBF"));
    EXPECT_FALSE(isUtf8("\xF0\x8F\xBF\xBF"));
    EXPECT_FALSE(isUtf8("\xED\xA0\x80")) << "surrogate";
    EXPECT_FALSE(isUtf8("\xED\xBF\xBF"));
    EXPECT_FALSE(isUtf8("\xF4\x90\x80\x80")) << "above U+10FFFF";
    EXPECT_FALSE(isUtf8("\xF8\x88\x80\x80\x80"));
    EXPECT_FALSE(isUtf8("\xFF"));
    EXPECT_FALSE(isUtf8("\x80"));
    for (const std::string cut : {"\xC3", "\xE2\x82", "\xF0\x9F\xA4", "\xE2\x82z", "\xC3z"}) {
        EXPECT_FALSE(isUtf8(cut)) << testing::PrintToString(cut);
        EXPECT_FALSE(isUtf8("a" + cut)) << testing::PrintToString(cut);
    }
}

TEST(Utf8, FirstCharacterHasItsCodePointAndSize) {
    const auto euro = firstCharacter("\xE2\x82\xAC...");
    ASSERT_TRUE(euro);
    EXPECT_EQ(euro->code_point, 0x20ACU);
    EXPECT_EQ(euro->size, 3U);
    const auto nul = firstCharacter(std::string_view("\0", 1));
    ASSERT_TRUE(nul);
    EXPECT_EQ(nul->code_point, 0U);
    EXPECT_EQ(nul->size, 1U);
    EXPECT_FALSE(firstCharacter(""));
}

}  // namespace
}  // namespace metier
