// Each kind of step without a failure, and the sources of values.
#include <gmock/gmock.h>

#include "bench.hpp"

namespace metier::composition {
namespace {

using namespace std::chrono_literals;
using skill::Frame;
using skill::Reason;
using skill::Value;
using skill::ValueMap;
using testing::Bench;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::kHead;
using testing::kHeadWithGrip;

TEST(Sequence, RunsItsStepsOneAfterTheOther) {
    Bench bench(kHead + R"(
[[step]]
name = "first"
run = "a"
[[step]]
name = "second"
run = "b"
)");
    ASSERT_TRUE(bench.start());
    EXPECT_TRUE(bench["a"].runs());
    EXPECT_FALSE(bench["b"].runs());
    EXPECT_EQ(bench.program->step(), "first");
    bench["a"].finish();
    bench.run();
    EXPECT_TRUE(bench["b"].runs());
    EXPECT_EQ(bench.program->step(), "second");
    EXPECT_EQ(bench.state(), "Running");
    bench["b"].finish();
    bench.run();
    EXPECT_EQ(bench.state(), "Ready");
    EXPECT_EQ(bench.program->reason(), Reason::finished);
}

TEST(Sequence, NamesTheExecutionsOfItsStepsAfterItsOwn) {
    Bench bench(kHead + R"(
[[step]]
name = "first"
run = "a"
[[step]]
name = "second"
run = "b"
)");
    ASSERT_TRUE(bench.start());
    EXPECT_EQ(bench["a"].request.execution_id, "here.TestSkill/run/first/1");
    bench["a"].finish();
    EXPECT_EQ(bench["b"].request.execution_id, "here.TestSkill/run/second/2");
    EXPECT_EQ(bench["b"].request.on_owner_loss, skill::OwnerLossAction::halt);
}

TEST(Sequence, ShortensIdsThatWouldBeTooLong) {
    Bench bench(kHead +
                "[[step]]\nname = \"first\"\nrun = \"a\"\n[[step]]\nname = \"s\"\nrun = \"b\"\n");
    const std::string id(120, 'x');
    ASSERT_TRUE(bench.program->startWith(testing::kClient, {id, {}}));
    const auto& used = bench["a"].request.execution_id;
    EXPECT_LE(used.size(), 128U);
    EXPECT_EQ(used.find("here.TestSkill/"), 0U);
    EXPECT_NE(used.find("/first/1"), std::string::npos);
}

TEST(Sequence, GivesParametersResultsAndConstantsToItsSteps) {
    Bench bench(kHeadWithGrip + R"(
[parameters.Force]
type = "number"
unit = "N"
default = 7
[parameters.Pose]
type = "frame"
[results.Width]
type = "number"
unit = "m"
from = "grasp.Width"
[[step]]
name = "grasp"
run = "grip"
with.Force = { from = "Force" }
[[step]]
name = "move"
run = "a"
with.Target = { from = "grasp.Width" }
with.Pose = { from = "Pose", shift = [0, 1, { from = "grasp.Width" }] }
with.Joints = [1, { from = "Pose", element = "z" }]
[[step]]
name = "back"
run = "b"
with.Target = { from = "Pose", element = 0, shift = 0.5 }
with.Joints = [1, 2.5]
)");
    ASSERT_TRUE(bench.start({{"Pose", Frame{1, 2, 3, 0, 0, 1}}}));
    EXPECT_EQ(bench["grip"].request.parameters, (ValueMap{{"Force", 7.0}}));
    bench["grip"].finish({{"Width", 0.25}, {"Held", true}});
    EXPECT_EQ(bench["a"].request.parameters, (ValueMap{{"Target", 0.25},
                                                       {"Pose", Frame{1, 3, 3.25, 0, 0, 1}},
                                                       {"Joints", std::vector<double>{1.0, 3.0}}}));
    bench["a"].finish();
    EXPECT_EQ(bench["b"].request.parameters,
              (ValueMap{{"Target", 1.5}, {"Joints", std::vector<double>{1.0, 2.5}}}));
    bench["b"].finish();
    bench.run();
    EXPECT_EQ(bench.program->finalResult(), (ValueMap{{"Width", 0.25}}));
}

TEST(Sequence, ShiftsAFrameAlongItsOwnAxesIfAsked) {
    Bench bench(kHead + R"(
[parameters.Pose]
type = "frame"
[parameters.Distance]
type = "number"
unit = "m"
[[step]]
name = "before"
run = "a"
with.Pose = { from = "Pose", shift = [0, 0, { from = "Distance", times = -1 }], shift_axes = "own" }
[[step]]
name = "rest"
run = "b"
)");
    constexpr double kHalfTurn = 3.141592653589793;
    ASSERT_TRUE(
        bench.start({{"Pose", Frame{0.5, 0.1, 0.2, kHalfTurn, 0, 0.4}}, {"Distance", 0.25}}));
    const auto pose = std::get<Frame>(bench["a"].request.parameters.at("Pose"));
    EXPECT_NEAR(pose.x, 0.5, 1e-12);
    EXPECT_NEAR(pose.y, 0.1, 1e-12);
    EXPECT_NEAR(pose.z, 0.45, 1e-12) << "the tool looks down, so before it is above";
    EXPECT_EQ(pose.c, 0.4);
}

TEST(Sequence, TellsWhichStepsItDidAndHowLongEachTook) {
    Bench bench(kHead + R"(
[results.Steps]
type = "texts"
from = "execution.Steps"
[results.Durations]
type = "numbers"
unit = "s"
from = "execution.Durations"
[[step]]
name = "group"
[[step.sequence]]
name = "first"
run = "a"
[[step]]
name = "second"
run = "b"
)");
    ASSERT_TRUE(bench.start());
    bench.advance(250ms);
    bench["a"].finish();
    bench.run();
    bench.advance(500ms);
    bench["b"].finish();
    bench.run();
    EXPECT_EQ(bench.program->finalResult(),
              (ValueMap{{"Steps", std::vector<std::string>{"group/first", "second"}},
                        {"Durations", std::vector<double>{0.25, 0.5}}}));
}

TEST(Sequence, TellsItsProgressWithThatOfItsSteps) {
    Bench bench(kHead + R"(
[[step]]
name = "first"
run = "a"
[[step]]
name = "second"
run = "b"
)");
    ASSERT_TRUE(bench.start());
    bench["a"].listener->onProgress(Value(0.5));
    bench.run();
    EXPECT_THAT(bench.observer.log, Contains("progress 0.25"));
    bench["a"].finish();
    bench.run();
    EXPECT_THAT(bench.observer.log, Contains("progress 0.5"));
}

const std::string kParallel = kHead + R"(
[[step]]
name = "both"
WAIT
[[step.parallel]]
name = "left"
run = "a"
[[step.parallel]]
name = "right"
run = "b"
)";

std::string parallel(const std::string& wait) {
    auto text = kParallel;
    return text.replace(text.find("WAIT"), 4, wait);
}

TEST(Parallel, WaitsForAllItsBranches) {
    Bench bench(parallel(""));
    ASSERT_TRUE(bench.start());
    EXPECT_TRUE(bench["a"].runs() && bench["b"].runs());
    EXPECT_EQ(bench.program->step(), "both/left, both/right");
    bench["b"].finish();
    bench.run();
    EXPECT_EQ(bench.state(), "Running");
    EXPECT_EQ(bench.program->step(), "both/left");
    bench["a"].finish();
    bench.run();
    EXPECT_EQ(bench.state(), "Ready");
}

TEST(Parallel, HaltsTheOthersOnceOneHasSucceededIfOneIsEnough) {
    Bench bench(parallel("wait_for = \"any\""));
    ASSERT_TRUE(bench.start());
    bench["b"].finish();
    bench.run();
    EXPECT_THAT(bench["a"].heard(), ElementsAre("begin", "halt"));
    EXPECT_EQ(bench.state(), "Running") << "the other one has not ended";
    bench["a"].halted();
    bench.run();
    EXPECT_EQ(bench.state(), "Running") << "what was halted is reset";
    bench["a"].wasReset();
    bench.run();
    EXPECT_EQ(bench.state(), "Ready");
}

TEST(Parallel, FailsIfNoneSucceedsWhereOneIsEnough) {
    Bench bench(parallel("wait_for = \"any\""));
    ASSERT_TRUE(bench.start());
    bench["b"].halted(Reason::error, "stuck");
    bench.run();
    EXPECT_EQ(bench.state(), "Running");
    bench["a"].halted(Reason::error, "jammed");
    bench.run();
    EXPECT_EQ(bench.state(), "Halted");
    EXPECT_THAT(bench.why(), HasSubstr("stuck"));
    EXPECT_THAT(bench.why(), HasSubstr("jammed"));
}

TEST(Failure, EndsTheWholeInTheWordsOfTheFileAfterWhatComesBefore) {
    Bench bench(kHeadWithGrip + R"(
[results.Held]
type = "boolean"
from = "grasp.Held"
[[step]]
name = "take"
[[step.fallback]]
name = "grasp"
run = "grip"
with.Force = 5
[[step.fallback]]
name = "leave"
[[step.fallback.sequence]]
name = "up"
run = "a"
[[step.fallback.sequence]]
name = "no_part"
fail = "there is no part"
[[step]]
name = "on"
run = "b"
)");
    ASSERT_TRUE(bench.start());
    bench["grip"].halted(Reason::error, "missed");
    bench.run();
    EXPECT_TRUE(bench["a"].runs());
    bench["a"].finish();
    bench.run();
    EXPECT_EQ(bench.state(), "Halted");
    EXPECT_FALSE(bench["b"].runs());
    EXPECT_THAT(bench.why(), HasSubstr("missed"));
    EXPECT_THAT(bench.why(), HasSubstr("step take/leave/no_part: there is no part"));
}

const std::string kWatched = kHead + R"(
[[step]]
name = "carry"
[[step.parallel]]
name = "watch"
run = "a"
background = true
[[step.parallel]]
name = "move"
run = "b"
)";

TEST(Background, IsHaltedOnceTheOthersAreDone) {
    Bench bench(kWatched);
    ASSERT_TRUE(bench.start());
    bench["b"].finish();
    bench.run();
    EXPECT_THAT(bench["a"].heard(), ElementsAre("begin", "halt"));
    bench["a"].halted();
    bench.run();
    bench["a"].wasReset();
    bench.run();
    EXPECT_EQ(bench.state(), "Ready");
}

TEST(Background, HaltsTheOthersIfItFails) {
    Bench bench(kWatched);
    ASSERT_TRUE(bench.start());
    bench["a"].halted(Reason::error, "the part is lost");
    bench.run();
    EXPECT_THAT(bench["b"].heard(), ElementsAre("begin", "halt"));
    bench["b"].halted();
    bench.run();
    EXPECT_EQ(bench.state(), "Halted");
    EXPECT_THAT(bench.why(), HasSubstr("carry/watch"));
    EXPECT_THAT(bench.why(), HasSubstr("the part is lost"));
}

TEST(Background, MayEndBeforeTheOthers) {
    Bench bench(kWatched);
    ASSERT_TRUE(bench.start());
    bench["a"].finish();
    bench.run();
    EXPECT_EQ(bench.state(), "Running");
    EXPECT_EQ(bench.program->step(), "carry/move");
    bench["b"].finish();
    bench.run();
    EXPECT_EQ(bench.state(), "Ready");
}

TEST(Fallback, TakesTheFirstThatSucceeds) {
    Bench bench(kHead + R"(
[[step]]
name = "either"
[[step.fallback]]
name = "left"
run = "a"
[[step.fallback]]
name = "right"
run = "b"
)");
    ASSERT_TRUE(bench.start());
    bench["a"].halted(Reason::error, "stuck");
    bench.run();
    EXPECT_TRUE(bench["b"].runs());
    bench["b"].finish();
    bench.run();
    EXPECT_EQ(bench.state(), "Ready");
}

TEST(Fallback, TellsAllFailuresIfNothingIsLeft) {
    Bench bench(kHead + R"(
[[step]]
name = "either"
[[step.fallback]]
name = "left"
run = "a"
[[step.fallback]]
name = "right"
run = "b"
)");
    ASSERT_TRUE(bench.start());
    bench["a"].halted(Reason::error, "stuck");
    bench["b"].halted(Reason::limit_violated, "jammed");
    bench.run();
    EXPECT_EQ(bench.state(), "Halted");
    EXPECT_EQ(bench.program->reason(), Reason::limit_violated);
    EXPECT_THAT(bench.why(), HasSubstr("either/left"));
    EXPECT_THAT(bench.why(), HasSubstr("jammed"));
}

const std::string kChoice = kHeadWithGrip + R"(
[[step]]
name = "grasp"
run = "grip"
with.Force = 5
[[step]]
name = "decide"
if = IF
[[step.then]]
name = "left"
run = "a"
[[step.else]]
name = "right"
run = "b"
)";

std::string choice(const std::string& condition) {
    auto text = kChoice;
    return text.replace(text.find("IF"), 2, condition);
}

TEST(Choice, FollowsItsCondition) {
    struct Case {
        std::string condition;
        bool then;
    };
    for (const auto& [condition, then] : {
             Case{"{ from = \"grasp.Held\", is = true }", true},
             Case{"{ from = \"grasp.Held\", is = false }", false},
             Case{"{ from = \"grasp.Width\", less = 0.02 }", false},
             Case{"{ from = \"grasp.Width\", greater = 0.02 }", true},
             Case{"{ not = { from = \"grasp.Held\", is = true } }", false},
             Case{"{ all = [{ from = \"grasp.Held\", is = true }, { from = \"grasp.Width\", less "
                  "= 0.1 }] }",
                  true},
             Case{"{ all = [{ from = \"grasp.Held\", is = true }, { from = \"grasp.Width\", less "
                  "= 0.01 }] }",
                  false},
             Case{"{ any = [{ from = \"grasp.Held\", is = false }, { from = \"grasp.Width\", less "
                  "= 0.1 }] }",
                  true},
         }) {
        Bench bench(choice(condition));
        ASSERT_TRUE(bench.start());
        bench["grip"].finish({{"Width", 0.03}, {"Held", true}});
        EXPECT_EQ(bench["a"].runs(), then) << condition;
        EXPECT_EQ(bench["b"].runs(), !then) << condition;
    }
}

TEST(Choice, PassesOnIfThereIsNothingToDo) {
    Bench bench(kHeadWithGrip + R"(
[[step]]
name = "grasp"
run = "grip"
with.Force = 5
[[step]]
name = "decide"
if = { from = "grasp.Held", is = false }
[[step.then]]
name = "left"
run = "a"
[[step]]
name = "right"
run = "b"
)");
    ASSERT_TRUE(bench.start());
    bench["grip"].finish({{"Held", true}});
    EXPECT_TRUE(bench["b"].runs());
}

TEST(Parallel, TellsTheMeanProgressOfThoseThatItWaitsFor) {
    Bench bench(kParallel.substr(0, kParallel.find("WAIT")) +
                kParallel.substr(kParallel.find("WAIT") + 4));
    ASSERT_TRUE(bench.start());
    bench["a"].listener->onProgress(Value(0.5));
    bench.run();
    EXPECT_EQ(bench.program->intermediate(), Value(0.25));
    bench["b"].finish();
    bench.run();
    EXPECT_EQ(bench.program->intermediate(), Value(0.75));
}

TEST(Background, CountsForNoProgress) {
    Bench bench(kWatched);
    ASSERT_TRUE(bench.start());
    bench["a"].listener->onProgress(Value(0.5));
    bench.run();
    EXPECT_EQ(bench.program->intermediate(), Value(0.0));
    bench["b"].listener->onProgress(Value(0.5));
    bench.run();
    EXPECT_EQ(bench.program->intermediate(), Value(0.5));
}

TEST(Parallel, HaltsEveryOtherBranchAtTheFirstFailure) {
    Bench bench(parallel("wait_for = \"all\""));
    ASSERT_TRUE(bench.start());
    bench["b"].halted(Reason::error, "stuck");
    bench.run();
    EXPECT_THAT(bench["a"].heard(), ElementsAre("begin", "halt"));
    bench["a"].halted(Reason::error, "braked badly");
    bench.run();
    EXPECT_EQ(bench.why(), "step both/right: MoveSkill b was Halted (Error): stuck");
}

TEST(Parallel, OfWhichOneIsEnoughFailsAtOnceIfAClientHaltsOne) {
    Bench bench(parallel("wait_for = \"any\""));
    ASSERT_TRUE(bench.start());
    bench["b"].halted(Reason::by_client);
    bench.run();
    EXPECT_THAT(bench["a"].heard(), ElementsAre("begin", "halt"));
    bench["a"].halted();
    bench.run();
    EXPECT_EQ(bench.state(), "Halted");
    EXPECT_THAT(bench.why(), HasSubstr("both/right: MoveSkill b was Halted (ByClient)"));
}

TEST(Parallel, OfWhichOneIsEnoughNamesAllFailuresInTheirOrder) {
    Bench bench(parallel("wait_for = \"any\""));
    ASSERT_TRUE(bench.start());
    bench["b"].refused("stuck");
    bench["a"].refused("jammed");
    bench.run();
    EXPECT_EQ(bench.why(),
              "step both: no branch succeeded: step both/right: MoveSkill b refused Start: stuck; "
              "step both/left: MoveSkill a refused Start: jammed");
}

TEST(Parallel, FailsIfABranchDoesNotStopAlthoughOneWasEnough) {
    Bench bench(parallel("wait_for = \"any\""));
    ASSERT_TRUE(bench.start());
    bench["b"].finish();
    bench.advance(2s);
    EXPECT_EQ(bench.state(), "Halted");
    EXPECT_EQ(bench.why(), "step both/left: MoveSkill a did not end within 2 s after Halt");
}

TEST(Fallback, TellsAllFailuresInTheirOrder) {
    Bench bench(kHead + R"(
[[step]]
name = "either"
[[step.fallback]]
name = "left"
run = "a"
[[step.fallback]]
name = "right"
run = "b"
)");
    ASSERT_TRUE(bench.start());
    bench["a"].refused("stuck");
    bench.run();
    bench["b"].refused("jammed");
    bench.run();
    EXPECT_EQ(bench.why(),
              "step either: nothing is left to try: step either/left: MoveSkill a refused Start: "
              "stuck; step either/right: MoveSkill b refused Start: jammed");
}

TEST(Fallback, TriesNothingElseIfAClientHaltsOne) {
    Bench bench(kHead + R"(
[[step]]
name = "either"
[[step.fallback]]
name = "left"
run = "a"
[[step.fallback]]
name = "right"
run = "b"
)");
    ASSERT_TRUE(bench.start());
    bench["a"].halted(Reason::by_client);
    bench.run();
    EXPECT_EQ(bench.state(), "Halted");
    EXPECT_THAT(bench["b"].heard(), IsEmpty());
}

TEST(Fallback, TriesNothingElseOnceItIsHalted) {
    Bench bench(kHead + R"(
[[step]]
name = "either"
[[step.fallback]]
name = "left"
run = "a"
[[step.fallback]]
name = "right"
run = "b"
)");
    ASSERT_TRUE(bench.start());
    ASSERT_TRUE(bench.call(skill::Method::halt));
    bench["a"].refused("stuck");
    bench.run();
    EXPECT_EQ(bench.state(), "Halted");
    EXPECT_EQ(bench.program->subState(), skill::SubState::halted_by_client);
    EXPECT_THAT(bench["b"].heard(), IsEmpty());
}

TEST(Fallback, TellsTheProgressOfTheOneThatItTries) {
    Bench bench(kHead + R"(
[[step]]
name = "either"
[[step.fallback]]
name = "left"
run = "a"
[[step.fallback]]
name = "right"
run = "b"
)");
    ASSERT_TRUE(bench.start());
    bench["a"].listener->onProgress(Value(0.5));
    bench.run();
    EXPECT_EQ(bench.program->intermediate(), Value(0.5));
    bench["a"].refused("stuck");
    bench.run();
    EXPECT_EQ(bench.program->intermediate(), Value(0.0));
}

TEST(Sequence, TakesNoProgressThatIsNone) {
    Bench bench(parallel(""));
    ASSERT_TRUE(bench.start());
    for (const Value& none : {Value(-0.1), Value(1.1), Value(true), Value(std::string("half"))}) {
        bench["a"].listener->onProgress(none);
    }
    bench.run();
    EXPECT_EQ(bench.program->intermediate(), Value(0.0));
    bench["a"].listener->onProgress(Value(1.0));
    bench.run();
    EXPECT_EQ(bench.program->intermediate(), Value(0.5));
    bench["a"].listener->onProgress(Value(0.0));
    bench.run();
    EXPECT_EQ(bench.program->intermediate(), Value(0.0));
}

TEST(Sequence, IsShownWhatItStartsWithNameAndSkill) {
    Bench bench(parallel(""));
    ASSERT_TRUE(bench.start());
    ASSERT_EQ(bench.observer.children.size(), 2U);
    EXPECT_EQ(bench.observer.children[0].id, "here.TestSkill/run/left/1");
    EXPECT_EQ(bench.observer.children[0].skill, "MoveSkill");
    EXPECT_EQ(bench.observer.children[1].id, "here.TestSkill/run/right/2");
    EXPECT_EQ(bench["a"].request.parent.id, "run");
}

TEST(Sequence, ShortensOnlyIdsThatWouldBeTooLong) {
    const std::string text = kHead +
                             "[[step]]\nname = \"first\"\nrun = \"a\"\n[[step]]\nname = "
                             "\"s\"\nrun = \"b\"\n";
    // "here.TestSkill/" and "/first/1" take 23 of 128 characters.
    Bench longest(text);
    const std::string fits(105, 'x');
    ASSERT_TRUE(longest.program->startWith(testing::kClient, {fits, {}}));
    EXPECT_EQ(longest["a"].request.execution_id, "here.TestSkill/" + fits + "/first/1");
    Bench over(text);
    ASSERT_TRUE(over.program->startWith(testing::kClient, {fits + "x", {}}));
    EXPECT_EQ(over["a"].request.execution_id.size(), 15U + 16U + 8U);
    Bench other(text);
    ASSERT_TRUE(other.program->startWith(testing::kClient, {fits + "y", {}}));
    EXPECT_NE(over["a"].request.execution_id, other["a"].request.execution_id);
}

TEST(Choice, ThatCannotBeMadeFailsTheSkill) {
    Bench bench(choice("{ from = \"grasp.Held\", is = true }"));
    ASSERT_TRUE(bench.start());
    bench["grip"].finish({{"Width", 0.03}});
    bench.run();
    EXPECT_EQ(bench.state(), "Halted");
    EXPECT_THAT(bench.why(), HasSubstr("step decide: step[1].if.is (line"));
    EXPECT_THAT(bench.why(), HasSubstr("grasp.Held has no value"));
}

TEST(Choice, IsHaltedWithItsSteps) {
    Bench bench(choice("{ from = \"grasp.Held\", is = true }"));
    ASSERT_TRUE(bench.start());
    bench["grip"].finish({{"Width", 0.03}, {"Held", true}});
    bench["a"].listener->onProgress(Value(0.5));
    bench.run();
    EXPECT_EQ(bench.program->intermediate(), Value(0.75));
    ASSERT_TRUE(bench.call(skill::Method::halt));
    EXPECT_THAT(bench["a"].heard(), ElementsAre("begin", "halt"));
}

}  // namespace
}  // namespace metier::composition
