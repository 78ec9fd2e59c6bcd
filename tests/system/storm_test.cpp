#include <gmock/gmock.h>

#include "storm.hpp"

namespace metier::system_tests {
namespace {

using ::testing::IsEmpty;

TEST(Storm, OfEightClientsOnSharedSkillsLosesAndReordersNothing) {
    StormOptions options;
    options.transitions = 3'000;
    const auto report = runStorm(options);
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_THAT(report->defects, IsEmpty());
    EXPECT_GE(report->transitions, options.transitions);
    EXPECT_EQ(report->events, report->transitions * options.clients);
}

TEST(Storm, OfTwoClientsOnOneSkillLosesAndReordersNothing) {
    const auto report = runStorm({.transitions = 500, .clients = 2, .skills = 1, .seed = 7});
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_THAT(report->defects, IsEmpty());
    EXPECT_EQ(report->events, report->transitions * 2);
}

}  // namespace
}  // namespace metier::system_tests
