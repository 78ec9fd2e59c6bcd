#include "metier/opcua/text.hpp"

#include <gtest/gtest.h>

#include <string_view>

namespace metier::opcua {
namespace {

constexpr const char* kMark = "\xEF\xBF\xBD";

TEST(Sanitise, KeepsWellFormedText) {
    EXPECT_EQ(sanitise("Größe 5 µm, 機械 🤖"), "Größe 5 µm, 機械 🤖");
}

TEST(Sanitise, MarksControlCharactersOfATerminal) {
    EXPECT_EQ(sanitise("a\x1b[2Jb\nc"), std::string("a") + kMark + "[2Jb" + kMark + "c");
}

TEST(Sanitise, MarksTextDirectionOverrides) {
    EXPECT_EQ(
        sanitise("a\xE2\x80\xAE"  // NOLINT(misc-misleading-bidirectional): it is what is tried
                 "b"),
        std::string("a") + kMark + "b");
}

TEST(Sanitise, MarksEachByteThatIsNotUtf8) {
    EXPECT_EQ(sanitise("\xFFx\xC0\x80"), std::string(kMark) + "x" + kMark + kMark);
}

TEST(Sanitise, MarksASequenceThatIsCutOff) {
    EXPECT_EQ(sanitise("ab\xE2\x82"), std::string("ab") + kMark + kMark);
}

TEST(Sanitise, MarksSurrogatesAndOverlongForms) {
    EXPECT_EQ(sanitise("\xED\xA0\x80"), std::string(kMark) + kMark + kMark);
    EXPECT_EQ(sanitise("\xE0\x80\xAF"), std::string(kMark) + kMark + kMark);
}

TEST(Sanitise, MarksAZeroByte) {
    EXPECT_EQ(sanitise(std::string_view("a\0b", 3)), std::string("a") + kMark + "b");
}

}  // namespace
}  // namespace metier::opcua
