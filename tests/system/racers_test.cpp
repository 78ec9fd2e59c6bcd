#include "racers.hpp"

#include <gmock/gmock.h>

namespace metier::system_tests {
namespace {

using ::testing::IsEmpty;

class Racers : public ::testing::TestWithParam<std::size_t> {};

TEST_P(Racers, NeverStartASkillWithValuesOfTwoClients) {
    const auto report =
        runRace({.rounds = 100, .baseline_rounds = 0, .clients = GetParam(), .seed = 7});
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_EQ(report->skill.mixed, 0U);
    EXPECT_THAT(report->defects, IsEmpty());
    EXPECT_GT(report->skill.started, report->skill.rounds / 2);
}

INSTANTIATE_TEST_SUITE_P(Clients, Racers, ::testing::Values(2, 3, 5, 8));

// Checks the race itself: a Program as in the standard starts with values of several clients.
TEST(PlainPrograms, MixWhereSkillsDoNot) {
    const auto report = runRace({.rounds = 100, .baseline_rounds = 100, .clients = 4});
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_GT(report->baseline.mixed, 0U);
    EXPECT_EQ(report->skill.mixed, 0U);
    EXPECT_THAT(report->defects, IsEmpty());
}

}  // namespace
}  // namespace metier::system_tests
