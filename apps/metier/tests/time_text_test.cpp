#include "time_text.hpp"

#include <gmock/gmock.h>

#include <chrono>

namespace metier::app {
namespace {

using namespace std::chrono_literals;

constexpr UtcTime kMidnight{1'795'305'600s};  // 2026-11-22

TEST(ParseTime, TakesDaysAndTimesInUtc) {
    EXPECT_EQ(parseTime("2026-11-22", {}).value(), kMidnight);
    EXPECT_EQ(parseTime("2026-11-22T09:30", {}).value(), kMidnight + 9h + 30min);
    EXPECT_EQ(parseTime("2026-11-22T09:30Z", {}).value(), kMidnight + 9h + 30min);
    EXPECT_EQ(parseTime("2026-11-22T09:30:05.5Z", {}).value(), kMidnight + 9h + 30min + 5500ms);
}

TEST(ParseTime, TakesHowLongAgo) {
    EXPECT_EQ(parseTime("90s", kMidnight).value(), kMidnight - 90s);
    EXPECT_EQ(parseTime("1.5h", kMidnight).value(), kMidnight - 90min);
    EXPECT_EQ(parseTime("7d", kMidnight).value(), kMidnight - 7 * 24h);
}

TEST(ParseTime, RefusesWhatIsNoTimeAndSaysWhatItWas) {
    for (const auto* text :
         {"", "yesterday", "2026-13-01", "2026-02-30", "2026-11-22T24:00", "2026-11-22T09:60",
          "2026-11-22T", "2026-11-22T09:30:61", "2026-11-22 09:30", "-5m", "5", "5w", "nanh",
          "2026-11-22T09:30:nan"}) {
        const auto refused = parseTime(text, kMidnight);
        ASSERT_FALSE(refused) << text;
        EXPECT_EQ(refused.error().code, Errc::invalid_argument);
        EXPECT_THAT(refused.error().message, ::testing::HasSubstr(std::string("'") + text + "'"));
    }
}

}  // namespace
}  // namespace metier::app
