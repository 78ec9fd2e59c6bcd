// Steps that are repeated.
#include <gmock/gmock.h>

#include "bench.hpp"

namespace metier::composition {
namespace {

using namespace std::chrono_literals;
using skill::Reason;
using skill::Value;
using testing::Bench;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::kHead;
using testing::kHeadWithGrip;

TEST(Loop, RepeatsAsOftenAsAParameterSays) {
    Bench bench(kHead + R"(
[parameters.Laps]
type = "uint32"
range = [0, 9]
[[step]]
name = "laps"
times = { from = "Laps" }
[[step.repeat]]
name = "there"
run = "a"
[[step.repeat]]
name = "back"
run = "b"
)");
    ASSERT_TRUE(bench.start({{"Laps", std::uint32_t{2}}}));
    EXPECT_EQ(bench.program->step(), "laps[1]/there");
    for (int lap = 0; lap < 2; ++lap) {
        bench["a"].finish();
        bench.run();
        bench["b"].finish();
        bench.run();
    }
    EXPECT_EQ(bench.state(), "Ready");
    EXPECT_THAT(bench["a"].heard(), ElementsAre("begin", "begin"));
    ASSERT_TRUE(bench.start({{"Laps", std::uint32_t{0}}}));
    EXPECT_EQ(bench.state(), "Ready");
    EXPECT_TRUE(bench["a"].heard().empty());
}

TEST(Loop, EndsWhenItsConditionHoldsAfterARound) {
    Bench bench(kHeadWithGrip + R"(
[[step]]
name = "move"
run = "a"
[[step]]
name = "other"
run = "b"
[[step]]
name = "until_held"
at_most = 3
until = { from = "grasp.Held", is = true }
[[step.repeat]]
name = "grasp"
run = "grip"
with.Force = 5
)");
    ASSERT_TRUE(bench.start());
    bench["a"].finish();
    bench["b"].finish();
    bench["grip"].finish({{"Held", false}});
    bench.run();
    EXPECT_TRUE(bench["grip"].runs());
    bench["grip"].finish({{"Held", true}});
    bench.run();
    EXPECT_EQ(bench.state(), "Ready");
}

TEST(Loop, FailsAtItsBound) {
    Bench bench(kHeadWithGrip + R"(
[[step]]
name = "move"
run = "a"
[[step]]
name = "other"
run = "b"
[[step]]
name = "until_held"
at_most = 2
until = { from = "grasp.Held", is = true }
[[step.repeat]]
name = "grasp"
run = "grip"
with.Force = 5
)");
    ASSERT_TRUE(bench.start());
    bench["a"].finish();
    bench["b"].finish();
    for (int round = 0; round < 2; ++round) {
        bench["grip"].finish({{"Held", false}});
        bench.run();
    }
    EXPECT_EQ(bench.state(), "Halted");
    EXPECT_EQ(bench.why(), "step until_held: not done after 2 rounds");
}

TEST(Loop, GoesOnWhileItsConditionHolds) {
    Bench bench(kHeadWithGrip + R"(
[[step]]
name = "first"
run = "grip"
with.Force = 5
[[step]]
name = "until_held"
at_most = 5
while = { from = "first.Held", is = false }
[[step.repeat]]
name = "move"
run = "a"
[[step.repeat]]
name = "other"
run = "b"
)");
    ASSERT_TRUE(bench.start());
    bench["grip"].finish({{"Held", true}});
    bench.run();
    EXPECT_EQ(bench.state(), "Ready");
    EXPECT_TRUE(bench["a"].heard().empty());
}

/// A loop over `a`, with the keys that it is to have; then `b`.
std::string looped(const std::string& keys) {
    return kHead + R"(
[parameters.Times]
type = "number"
range = [-9, 2000000]
default = 2
[parameters.Ok]
type = "boolean"
default = true
[[step]]
name = "laps"
)" + keys + R"(
[[step.repeat]]
name = "lap"
run = "a"
[[step]]
name = "after"
run = "b"
)";
}

TEST(Loop, NeedsAWholeNumberOfRounds) {
    for (const double times : {1.5, -1.0, 1'000'001.0}) {
        Bench bench(looped("times = { from = \"Times\" }"));
        ASSERT_TRUE(bench.start({{"Times", times}}));
        EXPECT_EQ(bench.state(), "Halted") << times;
        EXPECT_THAT(bench.why(), HasSubstr("step laps: times is "));
        EXPECT_THAT(bench.why(), HasSubstr("it needs a whole number from 0 to 1000000"));
        EXPECT_THAT(bench["a"].heard(), IsEmpty());
    }
    Bench bench(looped("times = { from = \"Times\" }"));
    ASSERT_TRUE(bench.start({{"Times", 1'000'000.0}}));
    EXPECT_TRUE(bench["a"].runs());
}

TEST(Loop, OfNoRoundsGoesOnWithTheNextStep) {
    Bench bench(looped("times = 0"));
    ASSERT_TRUE(bench.start());
    EXPECT_THAT(bench["a"].heard(), IsEmpty());
    EXPECT_TRUE(bench["b"].runs());
}

TEST(Loop, TellsHowFarItIs) {
    Bench bench(looped("times = 4"));
    ASSERT_TRUE(bench.start());
    bench["a"].finish();
    bench.run();
    EXPECT_EQ(bench.program->intermediate(), Value(0.125)) << "a round of four, of two steps";
    bench["a"].listener->onProgress(Value(0.5));
    bench.run();
    EXPECT_EQ(bench.program->intermediate(), Value(0.1875));
    for (int round = 0; round < 3; ++round) {
        bench["a"].finish();
        bench.run();
    }
    EXPECT_EQ(bench.program->intermediate(), Value(0.5));
}

TEST(Loop, WithoutTimesCountsItsMostRoundsForItsProgress) {
    Bench bench(looped("at_most = 4\nuntil = { from = \"Ok\", is = false }"));
    ASSERT_TRUE(bench.start());
    bench["a"].finish();
    bench.run();
    EXPECT_EQ(bench.program->intermediate(), Value(0.125));
}

TEST(Loop, IsDoneAfterItsTimesAlsoIfMoreAreAllowed) {
    Bench bench(looped("at_most = 2\ntimes = 2"));
    ASSERT_TRUE(bench.start());
    bench["a"].finish();
    bench.run();
    bench["a"].finish();
    bench.run();
    EXPECT_TRUE(bench["b"].runs());
}

TEST(Loop, StopsBeforeARoundForWhichItsConditionDoesNotHold) {
    Bench bench(looped("at_most = 9\nwhile = { from = \"Ok\", is = true }"));
    ASSERT_TRUE(bench.start({{"Ok", false}}));
    EXPECT_THAT(bench["a"].heard(), IsEmpty());
    EXPECT_TRUE(bench["b"].runs());
}

TEST(Loop, AsksItsEndConditionOnlyAfterARound) {
    Bench bench(looped("at_most = 9\nuntil = { from = \"Ok\", is = true }"));
    ASSERT_TRUE(bench.start());
    EXPECT_TRUE(bench["a"].runs());
    bench["a"].finish();
    bench.run();
    EXPECT_TRUE(bench["b"].runs());
}

TEST(Loop, FailsWithTheRoundInWhichAStepFailed) {
    Bench bench(looped("times = 3"));
    ASSERT_TRUE(bench.start());
    bench["a"].finish();
    bench.run();
    bench["a"].halted(Reason::error, "stuck");
    bench.run();
    EXPECT_EQ(bench.why(), "step laps[2]/lap: MoveSkill a was Halted (Error): stuck");
}

TEST(Loop, FailsIfItsConditionCannotBeAsked) {
    for (const auto* key : {"while", "until"}) {
        Bench bench(kHeadWithGrip + "[[step]]\nname = \"grasp\"\nrun = \"grip\"\nwith.Force = 1\n" +
                    "[[step]]\nname = \"laps\"\nat_most = 3\n" + key +
                    " = { from = \"grasp.Held\", is = true }\n[[step.repeat]]\nname = \"lap\"\nrun "
                    "= \"a\"\n[[step]]\nname = \"after\"\nrun = \"b\"\n");
        ASSERT_TRUE(bench.start());
        bench["grip"].finish();
        if (key == std::string("until")) {
            bench["a"].finish();
        }
        bench.run();
        EXPECT_EQ(bench.state(), "Halted") << key;
        EXPECT_THAT(bench.why(), HasSubstr("step laps: step[1]."));
        EXPECT_THAT(bench.why(), HasSubstr("grasp.Held has no value"));
    }
}

TEST(Loop, BeginsNoRoundOnceItIsHalted) {
    Bench bench(looped("times = 3"));
    ASSERT_TRUE(bench.start());
    bench["a"].finish();  // the next round begins in a later turn
    ASSERT_TRUE(bench.call(skill::Method::halt));
    EXPECT_EQ(bench.state(), "Halted");
    EXPECT_EQ(bench.program->subState(), skill::SubState::halted_by_client);
    EXPECT_THAT(bench["a"].heard(), ElementsAre("begin"));
}

}  // namespace
}  // namespace metier::composition
