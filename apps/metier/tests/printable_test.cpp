// Text from servers and controllers, as it gets to a terminal.
#include "printable.hpp"

#include <gmock/gmock.h>
#include <spdlog/logger.h>
#include <spdlog/sinks/ostream_sink.h>

#include <sstream>

namespace metier::app {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// Line that a log with that formatter writes for a message.
std::string logged(const std::string& message) {
    std::ostringstream out;
    const auto sink = std::make_shared<spdlog::sinks::ostream_sink_st>(out);
    sink->set_formatter(printableLog("[%l] %v"));
    spdlog::logger logger("test", sink);
    logger.warn(message);
    return out.str();
}

TEST(Printable, KeepsLinesAndWhatPeopleRead) {
    EXPECT_EQ(printable("one\ntwo"), "one\ntwo");
    EXPECT_EQ(printable("one\n"), "one\n");
    EXPECT_EQ(printable("\n\n"), "\n\n");
    EXPECT_EQ(printable("Gr\xc3\xb6\xc3\x9f"
                        "e \xe2\x82\xac"),
              "Gr\xc3\xb6\xc3\x9f"
              "e \xe2\x82\xac");
    EXPECT_EQ(printable(""), "");
}

TEST(Printable, LeavesNothingThatATerminalObeys) {
    for (const auto& text :
         {std::string("\x1b[2Jgone"), std::string("back\b\b\b\b"), std::string("over\rwritten"),
          std::string("bell\a"), std::string("nul\0byte", 8),
          std::string("csi\xc2\x9b"
                      "2J"),
          std::string("broken\xff\xfe")}) {
        const auto shown = printable(text);
        for (const char control : {'\x1b', '\b', '\r', '\a', '\0', '\xff'}) {
            EXPECT_EQ(shown.find(control), std::string::npos) << shown;
        }
        EXPECT_THAT(shown, Not(HasSubstr("\xc2\x9b"))) << "a control character of two bytes";
        EXPECT_THAT(shown, HasSubstr("\xef\xbf\xbd")) << "U+FFFD stands in its place";
    }
}

TEST(PrintableLog, AFurtherLineNeverLooksLikeALineOfTheLog) {
    EXPECT_EQ(logged("one\n[critical] not from here"),
              "[warning] one\n    [critical] not from here\n");
    EXPECT_THAT(logged("a\r[critical] b"), Not(HasSubstr("\r")));
}

TEST(PrintableLog, ACopyOfItsFormatterMakesTextPrintableToo) {
    std::ostringstream out;
    const auto sink = std::make_shared<spdlog::sinks::ostream_sink_st>(out);
    sink->set_formatter(printableLog("%v")->clone());
    spdlog::logger("test", sink).info("\x1b[2J");
    EXPECT_THAT(out.str(), Not(HasSubstr("\x1b")));
}

}  // namespace
}  // namespace metier::app
