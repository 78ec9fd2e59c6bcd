#include "synchronized_bench.hpp"

namespace metier::composition {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

TEST(SynchronizedMove, AsksEveryArmBeforeAnyMoves) {
    Bench bench;
    ASSERT_TRUE(bench.start());
    for (const auto* arm : {"left", "right"}) {
        EXPECT_THAT(bench[arm].pose->heard(), ElementsAre("check")) << arm;
        EXPECT_THAT(bench[arm].joint->heard(), IsEmpty()) << arm;
    }
    EXPECT_EQ(bench["right"].pose->checked.at("TargetPosition"),
              skill::Value(skill::Frame{0.5, 0, 0.4}));
    bench.answerCheck("left", 2.0, 0.0, 1.0);
    EXPECT_THAT(bench["left"].joint->heard(), ElementsAre("check")) << "the other has not answered";
    EXPECT_EQ(bench["left"].joint->checked.at("TargetJointPosition"),
              skill::Value(std::vector<double>{1.0}));
    bench.answerCheck("right", 3.0, 0.0, -1.0);
    EXPECT_THAT(bench["left"].joint->heard(), ElementsAre("compareClocks"));
}

TEST(SynchronizedMove, GivesAllTheSlowestOnesTimeAndTheirTargets) {
    Bench bench;
    bench.startBoth();
    EXPECT_EQ(bench.requested("left", "Duration"), 3.0);
    EXPECT_EQ(bench.requested("right", "Duration"), 3.0);
    EXPECT_EQ(bench["left"].joint->request.parameters.at("TargetJointPosition"),
              skill::Value(std::vector<double>{1.0}));
    EXPECT_EQ(bench["left"].joint->request.execution_id, "both.SynchronizedMoveSkill/run/left/1");
    EXPECT_EQ(bench["left"].joint->request.on_owner_loss, skill::OwnerLossAction::halt);
}

TEST(SynchronizedMove, TakesALongerDurationThanTheSlowestNeeds) {
    Bench bench;
    auto parameters = Bench::twoPoses();
    parameters["Duration"] = 8.0;
    ASSERT_TRUE(bench.start(parameters));
    bench.answerAll();
    EXPECT_EQ(bench.requested("left", "Duration"), 8.0);
}

TEST(SynchronizedMove, HasAllArmsStopInTheTimeOfTheSlowestForASuspend) {
    Bench bench;
    bench.startBoth();
    // Ways without a cruise: they brake for half of the shortest duration; 3 s are the common one.
    EXPECT_EQ(bench.requested("right", "StopTime"), 3.0) << "2.15 * 1.5 s is over what arms take";
    EXPECT_EQ(bench.requested("left", "StopTime"), bench.requested("right", "StopTime"));
}

TEST(SynchronizedMove, HasAllArmsStopSoonerWhenTheyMoveSlowly) {
    Bench bench;
    auto parameters = Bench::twoPoses();
    parameters["Duration"] = 48.0;
    ASSERT_TRUE(bench.start(parameters));
    bench.answerAll();
    EXPECT_NEAR(bench.requested("left", "StopTime"), 1.15 * 1.5 / 4.0, 1e-9);
}

TEST(SynchronizedMove, TellsEachArmTheMomentByItsOwnClock) {
    Bench bench;
    ASSERT_TRUE(bench.start());
    bench.answerCheck("left", 2.0, 0.0, 1.0);
    bench.answerCheck("right", 3.0, 0.0, -1.0);
    bench.answerClocks("left", 1500ms, 1ms);
    bench.answerClocks("right", -250ms, 1ms);
    EXPECT_NEAR(bench.requested("left", "StartTime"), bench.utc() + 0.5 + 1.5, 1e-6);
    EXPECT_NEAR(bench.requested("right", "StartTime"), bench.utc() + 0.5 - 0.25, 1e-6);
}

TEST(SynchronizedMove, ReportsTheSkewsByOneClock) {
    Bench bench;
    ASSERT_TRUE(bench.start());
    bench.answerCheck("left", 2.0, 0.0, 1.0);
    bench.answerCheck("right", 3.0, 0.0, -1.0);
    bench.answerClocks("left", 10s, 1ms);
    bench.answerClocks("right", 0ns, 2ms);
    bench.finish("left", 110.000, 113.004, 0.001);
    EXPECT_EQ(bench.state(), "Running") << "one has arrived";
    bench.finish("right", 100.003, 103.000, 0.009);
    EXPECT_EQ(bench.state(), "Ready");
    EXPECT_NEAR(bench.result("SkewAtStart"), 0.003, 1e-9);
    EXPECT_NEAR(bench.result("SkewAtEnd"), 0.004, 1e-9);
    EXPECT_NEAR(bench.result("LargestSkew"), 0.010, 1e-9);
    EXPECT_NEAR(bench.result("ClockUncertainty"), 0.003, 1e-9);
    EXPECT_NEAR(bench.result("Duration"), 3.004, 1e-9);
}

TEST(SynchronizedMove, ComparesOnlyArmsThatHadAWay) {
    Bench bench;
    ASSERT_TRUE(bench.start());
    bench.answerCheck("left", 0.0, 1.0, 1.0);
    bench.answerCheck("right", 3.0, 0.0, -1.0);
    bench.answerClocks("left", 0ns, 1ms);
    bench.answerClocks("right", 0ns, 1ms);
    EXPECT_FALSE(bench["left"].joint->request.parameters.contains("Duration"));
    bench.finish("left", 0.0, 0.0);
    bench.finish("right", 100.0, 103.0);
    EXPECT_EQ(bench.state(), "Ready");
    EXPECT_EQ(bench.result("SkewAtEnd"), 0.0);
    EXPECT_NEAR(bench.result("Duration"), 3.0, 1e-9);
}

TEST(SynchronizedMove, MovesNothingIfOneArmCannotGetThere) {
    Bench bench;
    ASSERT_TRUE(bench.start());
    bench.answerCheck("left", 2.0, 0.0, 1.0);
    bench.refuseCheck("right", "target: 1.2 m from axis 2, reach 0.8 m");
    EXPECT_EQ(bench.state(), "Halted");
    EXPECT_EQ(bench.why(),
              "right cannot get to its target: target: 1.2 m from axis 2, reach 0.8 m");
    EXPECT_THAT(bench["left"].joint->heard(), ElementsAre("check"));
    EXPECT_THAT(bench["right"].joint->heard(), IsEmpty());
}

TEST(SynchronizedMove, MovesNothingIfTheMoveOfAnArmIsHalted) {
    Bench bench;
    bench["right"].joint->state_now = skill::State::halted;
    bench["right"].joint->reason_text = "protective stop";
    ASSERT_TRUE(bench.start());
    EXPECT_THAT(bench["right"].joint->heard(), IsEmpty()) << "it was not halted here";
    bench.answerCheck("left", 2.0, 0.0, 1.0);
    skill::CheckReport report;
    report.joint_path = {{0.0}, {-1.0}};
    std::exchange(bench["right"].pose->check_done, nullptr)(report);
    report.possible = false;
    report.reason = "Start is not possible while Halted";
    std::exchange(bench["right"].joint->check_done, nullptr)(report);
    bench.run();
    EXPECT_EQ(bench.why(),
              "right cannot get to its target: Start is not possible while Halted (protective "
              "stop)");
}

TEST(SynchronizedMove, LeavesAnswersThatComeAfterItsEnd) {
    Bench bench;
    ASSERT_TRUE(bench.start());
    bench.refuseCheck("left", "out of reach");
    EXPECT_EQ(bench.state(), "Halted");
    bench.answerCheck("right", 3.0, 0.0, -1.0);
    EXPECT_THAT(bench["right"].joint->heard(), IsEmpty()) << "it was not asked further";
    EXPECT_EQ(bench.why(), "left cannot get to its target: out of reach");
}

TEST(SynchronizedMove, FailsIfAnArmDoesNotAnswer) {
    Bench bench;
    ASSERT_TRUE(bench.start());
    bench.answerCheck("left", 2.0, 0.0, 1.0);
    std::exchange(bench["right"].pose->check_done, nullptr)(fail(Errc::connection_lost, "gone"));
    bench.run();
    EXPECT_EQ(bench.why(), "right does not answer: gone");
    EXPECT_EQ(bench.program->reason(), skill::Reason::device_lost);

    Bench silent;
    ASSERT_TRUE(silent.start());
    silent.executor->advance(10s);
    EXPECT_EQ(silent.state(), "Halted");
    EXPECT_THAT(silent.why(), StartsWith("not all answered in time"));
}

TEST(SynchronizedMove, RefusesWhatDoesNotFitItsArms) {
    Bench bench;
    auto parameters = Bench::twoPoses();
    parameters["Arms"] = std::vector<std::string>{"left", "middle"};
    EXPECT_THAT(bench.start(parameters).error().message,
                HasSubstr("no \"middle\"; there are: left, right"));
    parameters["Arms"] = std::vector<std::string>{"left", "left"};
    EXPECT_THAT(bench.start(parameters).error().message, HasSubstr("\"left\" is there twice"));
    parameters = Bench::twoPoses();
    parameters["ToolFrames"] = std::vector<std::string>{"probe"};
    EXPECT_THAT(bench.start(parameters).error().message, HasSubstr("1 names for 2 arms"));
    bench["right"].joint->reachable = fail(Errc::connection_lost, "gone");
    EXPECT_THAT(bench.start().error().message, HasSubstr("right cannot be reached: gone"));
    EXPECT_EQ(bench.state(), "Ready");
}

TEST(SynchronizedMove, NeedsMovesThatTakeAStartTime) {
    EXPECT_EQ(unfitReason(moveDescription("JointPtpMoveSkill")), "");
    skill::SkillDescription old{
        .name = "JointPtpMoveSkill",
        .parameters = {
            {.name = "TargetJointPosition"}, {.name = "ToolFrame"}, {.name = "Duration"}}};
    EXPECT_EQ(unfitReason(old), "JointPtpMoveSkill has no parameter StartTime");
}

/// Check, with places of arms; the answer that it got.
std::optional<Result<skill::CheckReport>> check(Bench& bench, const skill::ArmPositions& starts) {
    std::optional<Result<skill::CheckReport>> answer;
    bench.program->check(kClient, {Bench::twoPoses(), starts},
                         [&](Result<skill::CheckReport> report) { answer = std::move(report); });
    bench.run();
    return answer;
}

TEST(CheckOfASynchronizedMove, AsksAllArmsForTheirReachAndEnds) {
    Bench bench;
    skill::ArmPositions starts;
    for (const std::string arm : {"left", "right"}) {
        bench[arm].pose->on_check = [&, arm](const skill::CheckRequest& request) {
            starts.insert(request.starts.begin(), request.starts.end());
            return skill::CheckReport{.planned_duration = arm == "left" ? 1.0 : 2.0,
                                      .ends = {{arm, {1.0}}},
                                      .ends_known = true};
        };
    }
    const auto report = check(bench, {{"", {0.5}}, {"elsewhere", {2.0}}});
    ASSERT_TRUE(report && *report);
    EXPECT_TRUE((*report)->possible);
    EXPECT_DOUBLE_EQ((*report)->planned_duration, 2.0);
    EXPECT_EQ((*report)->ends, (skill::ArmPositions{{"left", {1.0}}, {"right", {1.0}}}));
    EXPECT_EQ(starts, (skill::ArmPositions{{"", {0.5}}})) << "each gets the place of its own arm";
    EXPECT_EQ(bench.state(), "Ready");
}

TEST(CheckOfASynchronizedMove, NamesTheArmThatCannotGetToItsTarget) {
    Bench bench;
    bench["left"].pose->on_check = [](const auto& /*request*/) { return skill::CheckReport{}; };
    bench["right"].pose->on_check = [](const auto& /*request*/) -> skill::CheckReport {
        return {.possible = false, .reason = "1.2 m away", .code = "unreachable"};
    };
    const auto report = check(bench, {});
    ASSERT_TRUE(report && *report);
    EXPECT_FALSE((*report)->possible);
    EXPECT_EQ((*report)->reason, "right cannot get to its target: 1.2 m away");
    EXPECT_EQ((*report)->code, "unreachable");
}

TEST(CheckOfASynchronizedMove, DoesNotKnowIfAnArmDoesNotAnswer) {
    Bench bench;
    std::optional<Result<skill::CheckReport>> answer;
    bench.program->check(kClient, {Bench::twoPoses(), {}},
                         [&](Result<skill::CheckReport> report) { answer = std::move(report); });
    bench.executor->advance(9s);
    EXPECT_FALSE(answer);
    bench.executor->advance(2s);
    ASSERT_TRUE(answer && !*answer);
    EXPECT_EQ(answer->error().code, Errc::timeout);
    EXPECT_EQ(answer->error().message, "0 of 2 arms have answered");
}

}  // namespace
}  // namespace metier::composition
