// Steps that are tried again, and steps with a time limit.
#include <gmock/gmock.h>

#include "bench.hpp"

namespace metier::composition {
namespace {

using namespace std::chrono_literals;
using skill::Reason;
using testing::Bench;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::kHead;

TEST(Retry, TriesAgainAfterAPauseAndAReset) {
    Bench bench(kHead + R"(
reset = true
[[step]]
name = "first"
run = "a"
[[step]]
name = "move"
run = "b"
retry = 2
pause = 0.5
)");
    ASSERT_TRUE(bench.start());
    bench["a"].finish();
    bench["b"].halted(Reason::error, "missed");
    bench.advance(400ms);
    EXPECT_THAT(bench["b"].heard(), ElementsAre("begin"));
    bench.advance(100ms);
    EXPECT_THAT(bench["b"].heard(), ElementsAre("reset"));
    bench["b"].wasReset();
    EXPECT_THAT(bench["b"].heard(), ElementsAre("begin"));
    bench["b"].finish();
    bench.run();
    EXPECT_EQ(bench.state(), "Ready");
}

TEST(Retry, TellsTheLastFailureWhenItGivesUp) {
    Bench bench(kHead + R"(
reset = true
[[step]]
name = "first"
run = "a"
[[step]]
name = "move"
run = "b"
retry = 1
)");
    ASSERT_TRUE(bench.start());
    bench["a"].finish();
    bench["b"].refused("too far");
    bench.advance(0ms);
    bench["b"].refused("still too far");
    bench.run();
    EXPECT_EQ(bench.state(), "Halted");
    EXPECT_EQ(bench.why(), "step move: MoveSkill b refused Start: still too far (attempt 2 of 2)");
}

TEST(Retry, DoesNotOverrideAClientThatHaltedTheSkill) {
    Bench bench(kHead + R"(
reset = true
[[step]]
name = "first"
run = "a"
[[step]]
name = "move"
run = "b"
retry = 5
)");
    ASSERT_TRUE(bench.start());
    bench["a"].finish();
    bench["b"].halted(Reason::by_client);
    bench.advance(1s);
    EXPECT_EQ(bench.state(), "Halted");
    EXPECT_THAT(bench.why(), HasSubstr("step move: MoveSkill b was Halted (ByClient)"));
}

TEST(Timeout, HaltsTheStepAndFailsIt) {
    Bench bench(kHead + R"(
[[step]]
name = "move"
run = "a"
timeout = 3
[[step]]
name = "second"
run = "b"
)");
    ASSERT_TRUE(bench.start());
    bench.advance(2999ms);
    EXPECT_THAT(bench["a"].heard(), ElementsAre("begin"));
    bench.advance(1ms);
    EXPECT_THAT(bench["a"].heard(), ElementsAre("halt"));
    EXPECT_EQ(bench.state(), "Running") << "the child has not ended";
    bench["a"].halted();
    bench.run();
    EXPECT_EQ(bench.state(), "Halted");
    EXPECT_EQ(bench.why(), "step move: not done within 3 s");
}

const std::string kTimedAndTriedAgain = kHead + R"(
reset = true
[[step]]
name = "first"
run = "a"
[[step]]
name = "move"
run = "b"
timeout = 3
retry = 1
)";

TEST(Timeout, LetsNoRetryBeginBeforeTheStepHasStopped) {
    Bench bench(kTimedAndTriedAgain);
    ASSERT_TRUE(bench.start());
    bench["a"].finish();
    bench.advance(3s);
    EXPECT_THAT(bench["b"].heard(), ElementsAre("begin", "halt"));
    bench.advance(1s);
    EXPECT_THAT(bench["b"].heard(), IsEmpty()) << "it still brakes";
    bench["b"].halted();
    bench.advance(0s);
    EXPECT_THAT(bench["b"].heard(), ElementsAre("reset"));
    bench["b"].wasReset();
    bench.run();
    EXPECT_THAT(bench["b"].heard(), ElementsAre("begin"));
}

TEST(Timeout, OfAStepThatDoesNotStopIsNotTriedAgain) {
    Bench bench(kTimedAndTriedAgain);
    ASSERT_TRUE(bench.start());
    bench["a"].finish();
    bench.advance(3s);
    bench.advance(2s);
    EXPECT_EQ(bench.state(), "Halted");
    EXPECT_THAT(bench.why(), HasSubstr("step move: MoveSkill b did not end within 2 s after Halt"));
    bench.advance(10s);
    EXPECT_THAT(bench["b"].heard(), ElementsAre("begin", "halt")) << "it may still move";
}

TEST(Timeout, IsNoMatterOfWhatIsDoneInTime) {
    Bench bench(kHead + R"(
[[step]]
name = "move"
run = "a"
timeout = 3
[[step]]
name = "second"
run = "b"
)");
    ASSERT_TRUE(bench.start());
    bench["a"].finish();
    bench.advance(10s);
    EXPECT_THAT(bench["b"].heard(), ElementsAre("begin"));
    EXPECT_EQ(bench.state(), "Running");
}

TEST(Timeout, StandsStillWhileTheSkillIsSuspended) {
    Bench bench(kHead + R"(
[[step]]
name = "move"
run = "a"
timeout = 3
[[step]]
name = "second"
run = "b"
)");
    ASSERT_TRUE(bench.start());
    bench.advance(2s);
    ASSERT_TRUE(bench.call(skill::Method::suspend));
    bench["a"].suspended();
    bench.advance(60s);
    EXPECT_EQ(bench.state(), "Suspended");
    ASSERT_TRUE(bench.call(skill::Method::resume));
    bench.advance(999ms);
    EXPECT_THAT(bench["a"].heard(), ElementsAre("begin", "suspend", "resume"));
    bench.advance(1ms);
    EXPECT_THAT(bench["a"].heard(), ElementsAre("halt"));
}

TEST(Timeout, CountsEachAttemptAnew) {
    Bench bench(kTimedAndTriedAgain);
    ASSERT_TRUE(bench.start());
    bench["a"].finish();
    bench.advance(2s);
    bench["b"].refused("not yet");
    bench.advance(2s);
    EXPECT_THAT(bench["b"].heard(), ElementsAre("begin", "begin"));
    EXPECT_EQ(bench.state(), "Running");
    bench["b"].finish();
    bench.run();
    EXPECT_EQ(bench.state(), "Ready");
    EXPECT_EQ(bench.executor->timerCount(), 0U);
}

TEST(Timeout, IsNoLongerCountedOnceTheSkillIsHalted) {
    Bench bench(kTimedAndTriedAgain);
    ASSERT_TRUE(bench.start());
    bench["a"].finish();
    bench.advance(2s);
    ASSERT_TRUE(bench.call(skill::Method::halt));
    bench.advance(1s);
    bench["b"].halted();
    bench.run();
    EXPECT_EQ(bench.state(), "Halted");
    EXPECT_EQ(bench.program->subState(), skill::SubState::halted_by_client);
    EXPECT_THAT(bench["b"].heard(), ElementsAre("begin", "halt"));
}

TEST(Timeout, OfAllAttemptsNamesTheLast) {
    Bench bench(kTimedAndTriedAgain);
    ASSERT_TRUE(bench.start());
    bench["a"].finish();
    bench.advance(3s);
    bench["b"].halted();
    bench.advance(0s);
    bench["b"].wasReset();
    bench.advance(3s);
    bench["b"].halted();
    bench.run();
    EXPECT_EQ(bench.why(), "step move: not done within 3 s (attempt 2 of 2)");
}

}  // namespace
}  // namespace metier::composition
