// When a skill that names no executions runs as it was started here.
#include "skill_session.hpp"

#include <gtest/gtest.h>

namespace metier::dashboard {
namespace {

TEST(StartedRunTest, EndsWithItsEnd) {
    StartedRun run;
    EXPECT_TRUE(run.isOver());
    ASSERT_TRUE(run.begin(false));
    EXPECT_FALSE(run.isOver());
    run.answered(true);
    run.note(skill::State::running);
    run.note(skill::State::suspended);
    run.note(skill::State::running);
    EXPECT_FALSE(run.isOver());
    run.note(skill::State::ready);
    EXPECT_TRUE(run.isOver());
}

TEST(StartedRunTest, IsNotEndedByTheLateReportsOfTheOneBefore) {
    StartedRun run;
    run.begin(false);
    run.answered(true);
    ASSERT_FALSE(run.begin(false)) << "it may run";
    ASSERT_TRUE(run.begin(true)) << "it was seen at rest, and its transitions are on their way";
    run.answered(true);
    run.note(skill::State::running);
    run.note(skill::State::halted);
    EXPECT_FALSE(run.isOver());
    run.note(skill::State::running);
    run.note(skill::State::ready);
    EXPECT_TRUE(run.isOver());
}

TEST(StartedRunTest, StaysAsItWasIfAStartIsRefused) {
    StartedRun run;
    ASSERT_TRUE(run.begin(false));
    EXPECT_FALSE(run.begin(true)) << "a start is under way";
    run.answered(false);
    EXPECT_TRUE(run.isOver());
    run.note(skill::State::running);
    EXPECT_TRUE(run.isOver()) << "another client's";
    run.begin(false);
    run.answered(true);
    run.begin(true);
    run.answered(false);
    EXPECT_FALSE(run.isOver()) << "its end was not reported";
}

}  // namespace
}  // namespace metier::dashboard
