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

TEST(ParseTime, RefusesYearsBeyondWhatATimeHolds) {
    // A time has nanoseconds in 64 bits: from 1677 to 2262.
    for (const auto* text : {"9999-12-31", "2262-05-01T00:00", "1600-01-01", "0000-01-01"}) {
        const auto refused = parseTime(text, kMidnight);
        ASSERT_FALSE(refused) << text;
        EXPECT_EQ(refused.error().code, Errc::invalid_argument);
        EXPECT_THAT(refused.error().message, ::testing::HasSubstr("1970 to 2261")) << text;
    }
    EXPECT_TRUE(parseTime("2261-12-31T23:59:59", kMidnight));
    EXPECT_EQ(parseTime("1970-01-01", kMidnight).value(), UtcTime{});
}

TEST(ParseTime, RefusesToLookBackFurtherThanTimesGo) {
    for (const auto* text : {"1000000d", "36501d", "1e6h", "1e300s"}) {
        EXPECT_FALSE(parseTime(text, kMidnight)) << text;
    }
    EXPECT_EQ(parseTime("3650d", kMidnight).value(), kMidnight - 3650 * 24h);
    EXPECT_EQ(parseTime("0s", kMidnight).value(), kMidnight);
    EXPECT_EQ(parseTime("1000000s", kMidnight).value(), kMidnight - 1'000'000s);
}

TEST(ParseTime, TakesTheDaysThatTheCalendarHas) {
    EXPECT_TRUE(parseTime("2028-02-29", {}));
    for (const auto* text : {"2027-02-29", "2026-00-10", "2026-04-31", "2026-1-1", "26-01-01",
                             "2026-11-22T9:30", "2026-11-22T09:30:05.5ZZ", "2026-11-22Z09:30",
                             "2026/11/22", "2026-11-22T09:30+01:00", " 2026-11-22"}) {
        EXPECT_FALSE(parseTime(text, {})) << text;
    }
}

}  // namespace
}  // namespace metier::app
