#include <gmock/gmock.h>

#include <fmt/format.h>

#include <optional>

#include "bench.hpp"

namespace metier::composition {
namespace {

using namespace std::chrono_literals;
using skill::ArmPositions;
using skill::CheckReport;
using skill::CheckRequest;
using testing::Bench;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::kClient;
using testing::kHead;
using testing::kHeadWithGrip;
using testing::kTwoSteps;

/// Steps of one arm with one axis, by the names of the used skills: from where each was asked.
struct Line {
    /// Has the used skills of a bench answer as moves of one arm, to their Target.
    void moves(Bench& bench, const std::vector<std::string>& aliases) {
        for (const auto& alias : aliases) {
            bench[alias].on_check = [this, alias](const CheckRequest& request) {
                const auto start = request.starts.find("");
                const double from = start == request.starts.end() ? 0.0 : start->second.at(0);
                return answer(alias, from, std::get<double>(request.parameters.at("Target")));
            };
        }
    }

    CheckReport answer(const std::string& alias, double from, double to) {
        asked.push_back(fmt::format("{} {}->{}", alias, from, to));
        if (to - from > reach) {
            return {.possible = false,
                    .reason = fmt::format("{} m over reach {} m", to - from, reach),
                    .code = "unreachable",
                    .first_failing_fraction = 0.5};
        }
        return {.planned_duration = to - from, .ends = {{"", {to}}}, .ends_known = true};
    }

    double reach = 2.0;
    std::vector<std::string> asked;
};

std::optional<Result<CheckReport>> check(Bench& bench, skill::ValueMap parameters = {},
                                         const ArmPositions& starts = {}) {
    std::optional<Result<CheckReport>> answer;
    bench.program->check(kClient, {std::move(parameters), starts},
                         [&](Result<CheckReport> report) { answer = std::move(report); });
    bench.run();
    return answer;
}

CheckReport reportOf(Bench& bench, skill::ValueMap parameters = {},
                     const ArmPositions& starts = {}) {
    const auto answer = check(bench, std::move(parameters), starts);
    EXPECT_TRUE(answer && *answer);
    return answer && *answer ? **answer : CheckReport{.reason = "no answer"};
}

std::string step(const std::string& name, const std::string& alias, double target) {
    return fmt::format("[[step]]\nname = \"{}\"\nrun = \"{}\"\nwith.Target = {:.1f}\n", name, alias,
                       target);
}

TEST(CheckOfASequence, AsksEachStepFromWhereTheOneBeforeEnds) {
    Bench bench(kHead + step("first", "a", 1.0) + step("second", "b", 2.5) +
                step("third", "a", 4.0));
    Line line;
    line.moves(bench, {"a", "b"});
    const auto report = reportOf(bench);
    EXPECT_TRUE(report.possible) << report.reason;
    EXPECT_THAT(line.asked, ElementsAre("a 0->1", "b 1->2.5", "a 2.5->4"));
    EXPECT_DOUBLE_EQ(report.planned_duration, 4.0);
    EXPECT_EQ(report.ends, (ArmPositions{{"", {4.0}}}));
    EXPECT_TRUE(report.ends_known);
    EXPECT_THAT(report.notes, IsEmpty());
}

TEST(CheckOfASequence, NamesTheStepThatIsImpossible) {
    Bench bench(kHead + step("first", "a", 1.0) + step("second", "b", 4.0) +
                step("third", "a", 5.0));
    Line line;
    line.moves(bench, {"a", "b"});
    const auto report = reportOf(bench);
    EXPECT_FALSE(report.possible);
    EXPECT_EQ(report.reason, "step second: MoveSkill b cannot be done: 3 m over reach 2 m");
    EXPECT_EQ(report.code, "unreachable");
    EXPECT_DOUBLE_EQ(report.first_failing_fraction, 0.5);
    EXPECT_THAT(line.asked, ElementsAre("a 0->1", "b 1->4")) << "none after it";
}

TEST(CheckOfASequence, BeginsWhereItIsToldThatTheArmStandsThen) {
    Bench bench(kHead + step("first", "a", 6.0) + step("second", "b", 6.5));
    Line line;
    line.moves(bench, {"a", "b"});
    EXPECT_FALSE(reportOf(bench).possible);
    EXPECT_TRUE(reportOf(bench, {}, {{"", {5.0}}}).possible);
}

TEST(CheckOfASequence, UsesItsOwnParameters) {
    Bench bench(kHead + R"(
[parameters.Far]
type = "number"
unit = "m"
[[step]]
name = "go"
run = "a"
with.Target = { from = "Far" }
[[step]]
name = "back"
run = "b"
with.Target = 0.0
)");
    Line line;
    line.moves(bench, {"a", "b"});
    EXPECT_TRUE(reportOf(bench, {{"Far", 1.5}}).possible);
    EXPECT_FALSE(reportOf(bench, {{"Far", 2.5}}).possible);
}

const std::string kByResult = kHead + R"(
[[step]]
name = "first"
run = "a"
with.Target = 1.0
[[step]]
name = "second"
run = "b"
with.Target = { from = "first.Reached" }
[[step]]
name = "third"
run = "a"
with.Target = 9.0
)";

TEST(CheckOfASequence, NotesAValueThatIsNotKnownBeforeTheRunAndRefusesNothingForIt) {
    Bench bench(kByResult);
    Line line;
    line.moves(bench, {"a", "b"});
    const auto report = reportOf(bench);
    EXPECT_TRUE(report.possible) << report.reason;
    EXPECT_THAT(report.notes,
                ElementsAre("step second: MoveSkill b is not checked: Target comes from "
                            "first.Reached, which is not known before the run",
                            "step third: MoveSkill a is not possible now, and may be possible "
                            "then: 9 m over reach 2 m"))
        << "where the second step ends is not known either";
    EXPECT_THAT(line.asked, ElementsAre("a 0->1", "a 0->9"));
}

TEST(CheckOfASequence, NamesASkillWithoutCheck) {
    Bench bench(kTwoSteps);
    bench["b"].on_check = [](const auto& /*request*/) -> Result<CheckReport> {
        return fail(Errc::not_supported, "MoveSkill has no Check");
    };
    const auto report = reportOf(bench);
    EXPECT_TRUE(report.possible);
    EXPECT_THAT(report.notes,
                ElementsAre("step second: MoveSkill b is not checked: it has no Check"));
}

TEST(CheckOfASequence, LeavesAloneASkillThatIsNotReady) {
    Bench bench(testing::kOneThatIsReset);
    bench["b"].state_now = skill::State::halted;
    bench["b"].on_check = {};
    const auto report = reportOf(bench);
    EXPECT_TRUE(report.possible);
    EXPECT_THAT(report.notes, ElementsAre("step first: MoveSkill b is not checked: it is Halted"));
    EXPECT_THAT(bench["b"].heard(), IsEmpty());
}

TEST(CheckOfASequence, RefusesNothingForWhatMayBeGoneThen) {
    Bench bench(kTwoSteps);
    bench["b"].on_check = [](const auto& /*request*/) -> CheckReport {
        return {.possible = false, .reason = "holds no part", .code = "device_fault"};
    };
    const auto report = reportOf(bench);
    EXPECT_TRUE(report.possible);
    EXPECT_THAT(report.notes, ElementsAre(HasSubstr("step second: MoveSkill b is not possible now, "
                                                    "and may be possible then: holds no part")));
}

TEST(CheckOfASequence, BelievesAnOlderServerOnlyAboutItsFirstStep) {
    // It says neither why nor where its arm ends, and takes no place to begin at.
    Bench bench(kTwoSteps);
    std::vector<std::size_t> starts;
    const auto refuses = [&](const CheckRequest& request) -> CheckReport {
        starts.push_back(request.starts.size());
        return {.possible = false, .reason = "too far"};
    };
    bench["b"].on_check = refuses;
    EXPECT_TRUE(reportOf(bench).possible) << "the first step has moved its arm";
    bench["a"].on_check = refuses;
    EXPECT_EQ(reportOf(bench).reason, "step first: MoveSkill a cannot be done: too far");
    EXPECT_THAT(starts, ElementsAre(0, 0));
}

TEST(CheckOfASequence, DoesNotBelieveAnOlderServerThatAComposedSkillMayHaveUsed) {
    Bench bench(kTwoSteps);
    bench["a"].runs_others = true;
    bench["a"].url = "opc.tcp://component";
    bench["a"].on_check = [](const auto& /*request*/) -> CheckReport {
        return {.ends_known = true};
    };
    bench["b"].on_check = [](const auto& /*request*/) -> CheckReport {
        return {.possible = false, .reason = "the jaws are closed"};
    };
    EXPECT_TRUE(reportOf(bench).possible) << "the first step may open them";
}

TEST(CheckOfASequence, PassesOnTheNotesOfASkillThatIsComposedItself) {
    Bench bench(kTwoSteps);
    bench["a"].runs_others = true;
    bench["a"].on_check = [](const auto& /*request*/) -> CheckReport {
        return {.ends = {{"opc.tcp://arm", {1.0}}}, .ends_known = true, .notes = {"step x: hm"}};
    };
    bench["b"].runs_others = true;
    ArmPositions starts;
    bench["b"].on_check = [&](const CheckRequest& request) {
        starts = request.starts;
        return CheckReport{.ends_known = true};
    };
    const auto report = reportOf(bench);
    EXPECT_THAT(report.notes, ElementsAre("step first: MoveSkill a: step x: hm"));
    EXPECT_EQ(starts, (ArmPositions{{"opc.tcp://arm", {1.0}}})) << "it may move that arm, too";
    EXPECT_EQ(report.ends, starts);
}

const std::string kParallel = kHead + R"(
[[step]]
name = "both"
[[step.parallel]]
name = "one"
run = "a"
with.Target = 1.0
[[step.parallel]]
name = "other"
run = "b"
with.Target = 2.0
)";

TEST(CheckOfASequence, TakesTheLongestOfParallelSteps) {
    Bench bench(kParallel);
    Line line;
    line.moves(bench, {"a", "b"});
    const auto report = reportOf(bench);
    EXPECT_DOUBLE_EQ(report.planned_duration, 2.0);
    EXPECT_THAT(line.asked, ElementsAre("a 0->1", "b 0->2")) << "both begin at the same place";
    line.reach = 1.5;
    EXPECT_EQ(reportOf(bench).reason,
              "step both/other: MoveSkill b cannot be done: 2 m over reach 1.5 m");
}

const std::string kFallback = kHead + R"(
[[step]]
name = "try"
[[step.fallback]]
name = "far"
run = "a"
with.Target = 3.0
[[step.fallback]]
name = "near"
run = "b"
with.Target = 1.0
[[step]]
name = "on"
run = "a"
with.Target = 2.0
)";

TEST(CheckOfASequence, GoesOnWithTheFirstAlternativeThatIsPossible) {
    Bench bench(kFallback);
    Line line;
    line.moves(bench, {"a", "b"});
    const auto report = reportOf(bench);
    EXPECT_TRUE(report.possible);
    EXPECT_THAT(report.notes,
                ElementsAre("step try/far: MoveSkill a cannot be done: 3 m over reach 2 m"));
    EXPECT_THAT(line.asked, ElementsAre("a 0->3", "b 0->1", "a 1->2"));
    line.reach = 0.5;
    EXPECT_THAT(reportOf(bench).reason,
                HasSubstr("step try: nothing is left to try: step try/far: MoveSkill a cannot"));
}

TEST(CheckOfASequence, AlsoLooksAtTheAlternativesOfOneThatMayFailInTheRun) {
    Bench bench(kHeadWithGrip + R"(
[[step]]
name = "try"
[[step.fallback]]
name = "grasp"
run = "grip"
with.Force = 10
[[step.fallback]]
name = "near"
run = "a"
with.Target = 1.0
[[step]]
name = "on"
run = "b"
with.Target = 2.5
)");
    Line line;
    line.moves(bench, {"a", "b"});
    bench["grip"].on_check = [](const auto& /*request*/) -> CheckReport {
        return {
            .possible = false, .reason = "no part", .code = "invalid_state", .ends_known = true};
    };
    const auto report = reportOf(bench);
    EXPECT_TRUE(report.possible) << report.reason;
    EXPECT_THAT(report.notes,
                ElementsAre(HasSubstr("step try/grasp: GraspSkill grip is not possible now"),
                            HasSubstr("step on: MoveSkill b is not possible now")));
    EXPECT_THAT(line.asked, ElementsAre("a 0->1", "b 0->2.5"));
}

TEST(CheckOfASequence, BeginsAnAlternativeWhereTheOneBeforeCouldNotGoOn) {
    Bench bench(kHead + R"(
[[step]]
name = "try"
[[step.fallback]]
name = "two"
[[step.fallback.sequence]]
name = "near"
run = "a"
with.Target = 1.5
[[step.fallback.sequence]]
name = "far"
run = "a"
with.Target = 9.0
[[step.fallback]]
name = "one"
run = "b"
with.Target = 3.0
)");
    Line line;
    line.moves(bench, {"a", "b"});
    EXPECT_TRUE(reportOf(bench).possible);
    EXPECT_THAT(line.asked, ElementsAre("a 0->1.5", "a 1.5->9", "b 1.5->3"));
}

TEST(CheckOfASequence, DoesNotKnowWhereABackgroundStepIsHalted) {
    Bench bench(kHeadWithGrip + R"(
[[step]]
name = "both"
[[step.parallel]]
name = "work"
run = "grip"
with.Force = 10
[[step.parallel]]
name = "aside"
run = "a"
with.Target = 2.0
background = true
[[step]]
name = "on"
run = "b"
with.Target = 3.0
)");
    Line line;
    line.moves(bench, {"a", "b"});
    const auto report = reportOf(bench);
    EXPECT_TRUE(report.possible) << "it may have come near enough";
    EXPECT_THAT(report.notes, ElementsAre(HasSubstr("step on: MoveSkill b is not possible now")));
}

const std::string kAny = kHead + R"(
[[step]]
name = "some"
wait_for = "any"
[[step.parallel]]
name = "one"
run = "a"
with.Target = 3.0
[[step.parallel]]
name = "other"
run = "b"
with.Target = 1.0
[[step]]
name = "on"
run = "a"
with.Target = 9.0
)";

TEST(CheckOfASequence, NeedsOnePossibleBranchWhereOneIsEnough) {
    Bench bench(kAny);
    Line line;
    line.moves(bench, {"a", "b"});
    const auto report = reportOf(bench);
    EXPECT_TRUE(report.possible) << "where the arm is after the branches is not known";
    EXPECT_THAT(report.notes,
                ElementsAre("step some/one: MoveSkill a cannot be done: 3 m over reach 2 m",
                            HasSubstr("step on: MoveSkill a is not possible now")));
    line.reach = 0.5;
    EXPECT_THAT(reportOf(bench).reason,
                HasSubstr("step some: no branch can be done: step some/one"));
}

const std::string kChoice = kHead + R"(
[parameters.Long]
type = "boolean"
default = false
[[step]]
name = "way"
if = { from = "Long", is = true }
[[step.then]]
name = "long"
run = "a"
with.Target = 9.0
[[step.else]]
name = "short"
run = "b"
with.Target = 1.0
)";

TEST(CheckOfASequence, TakesTheBranchThatItsParametersChoose) {
    Bench bench(kChoice);
    Line line;
    line.moves(bench, {"a", "b"});
    EXPECT_TRUE(reportOf(bench).possible);
    EXPECT_THAT(line.asked, ElementsAre("b 0->1"));
    EXPECT_EQ(reportOf(bench, {{"Long", true}}).reason,
              "step way/long: MoveSkill a cannot be done: 9 m over reach 2 m");
}

const std::string kUnknownChoice = kHeadWithGrip + R"(
[[step]]
name = "grasp"
run = "grip"
with.Force = 20.0
[[step]]
name = "way"
if = { from = "grasp.Held", is = true }
[[step.then]]
name = "long"
run = "a"
with.Target = 9.0
[[step.else]]
name = "short"
run = "b"
with.Target = 1.0
)";

TEST(CheckOfASequence, ChecksBothBranchesOfAConditionThatIsNotKnownBeforeTheRun) {
    Bench bench(kUnknownChoice);
    bench["grip"].on_check = [](const auto& /*request*/) {
        return CheckReport{.ends_known = true};
    };
    Line line;
    line.moves(bench, {"a", "b"});
    auto report = reportOf(bench);
    EXPECT_TRUE(report.possible) << report.reason;
    EXPECT_THAT(report.notes,
                ElementsAre("step way: its branch depends on grasp.Held, which is not known before "
                            "the run",
                            "step way/long: MoveSkill a cannot be done: 9 m over reach 2 m"));
    line.reach = 0.5;
    report = reportOf(bench);
    EXPECT_FALSE(report.possible) << "neither branch can be done";
}

std::string loop(const std::string& head, const std::string& target) {
    return kHead + fmt::format(R"(
[parameters.Times]
type = "number"
default = 3
[[step]]
name = "again"
{}
[[step.repeat]]
name = "there"
run = "a"
with.Target = {}
[[step.repeat]]
name = "back"
run = "b"
with.Target = 0.0
)",
                               head, target);
}

TEST(CheckOfASequence, ChecksARoundOnceIfAllBeginAtTheSamePlace) {
    Bench bench(loop("times = { from = \"Times\" }\nat_most = 9", "1.0"));
    Line line;
    line.moves(bench, {"a", "b"});
    auto report = reportOf(bench);
    EXPECT_TRUE(report.possible) << report.reason;
    EXPECT_THAT(line.asked, ElementsAre("a 0->1", "b 1->0", "a 0->1", "b 1->0"))
        << "the first round begins where the arm stands, the second where the first ends";
    EXPECT_THAT(report.notes, IsEmpty());
    line.reach = 0.5;
    EXPECT_EQ(reportOf(bench).reason,
              "step again[1]/there: MoveSkill a cannot be done: 1 m over reach 0.5 m");
    EXPECT_TRUE(reportOf(bench, {{"Times", 0.0}}).possible) << "not once";
}

TEST(CheckOfASequence, FindsALoopImpossibleThatHasNoEnd) {
    Bench bench(loop("times = { from = \"Times\" }\nat_most = 9", "1.0"));
    Line line;
    line.moves(bench, {"a", "b"});
    EXPECT_TRUE(reportOf(bench, {{"Times", 9.0}}).possible);
    EXPECT_EQ(reportOf(bench, {{"Times", 12.0}}).reason, "step again: not done after 9 rounds");
    Bench endless(loop("while = { from = \"Times\", greater = 5 }\nat_most = 4", "1.0"));
    line.moves(endless, {"a", "b"});
    EXPECT_TRUE(reportOf(endless, {{"Times", 5.0}}).possible) << "not once";
    EXPECT_FALSE(reportOf(endless, {{"Times", 6.0}}).possible);
}

TEST(CheckOfASequence, NotesALoopWhoseRoundsAreNotKnownBeforeTheRun) {
    Bench bench(loop("until = { from = \"there.Reached\", greater = 5 }\nat_most = 9", "1.0"));
    Line line;
    line.moves(bench, {"a", "b"});
    const auto report = reportOf(bench);
    EXPECT_TRUE(report.possible) << report.reason;
    EXPECT_THAT(report.notes, ElementsAre("step again: how often it is repeated is not known "
                                          "before the run"));
    line.reach = 0.5;
    EXPECT_FALSE(reportOf(bench).possible) << "the first round comes in any case";
}

TEST(CheckOfASequence, AnswersThatItDoesNotKnowIfASkillTakesTooLong) {
    Bench bench(kTwoSteps);
    bench["b"].on_check = {};
    std::optional<Result<CheckReport>> answer;
    bench.program->check(kClient, {}, [&](Result<CheckReport> report) { answer = report; });
    bench.advance(9'900ms);
    EXPECT_FALSE(answer);
    bench.advance(200ms);
    ASSERT_TRUE(answer);
    ASSERT_FALSE(*answer);
    EXPECT_EQ(answer->error().code, Errc::timeout);
    bench["b"].check_done(CheckReport{});  // late: nobody hears it
}

TEST(CheckOfASequence, IsRefusedWhereStartWouldBe) {
    Bench bench(kTwoSteps);
    bench["b"].reachable = fail(Errc::connection_lost, "no answer");
    const auto report = reportOf(bench);
    EXPECT_FALSE(report.possible);
    EXPECT_EQ(report.code, "connection_lost");
    EXPECT_THAT(report.reason, HasSubstr("MoveSkill b (b) cannot be reached: no answer"));
}

TEST(CheckOfASequence, MayBeUnderWaySeveralTimesAndEndsWithTheSkill) {
    std::optional<Bench> bench(std::in_place, kTwoSteps);
    (*bench)["a"].on_check = {};
    int answers = 0;
    const auto count = [&](const auto& /*report*/) { ++answers; };
    bench->program->check(kClient, {}, count);
    const auto first = (*bench)["a"].check_done;
    bench->program->check(kClient, {}, count);
    const auto second = (*bench)["a"].check_done;
    second(CheckReport{});
    EXPECT_EQ(answers, 1);
    first(CheckReport{});
    EXPECT_EQ(answers, 2);
    bench->program->check(kClient, {}, count);
    const auto late = (*bench)["a"].check_done;
    bench.reset();
    late(CheckReport{});
    EXPECT_EQ(answers, 2);
}

}  // namespace
}  // namespace metier::composition
