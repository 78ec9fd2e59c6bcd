#include "metier/composition/definition_file.hpp"

#include <gmock/gmock.h>

#include <fstream>
#include <iterator>

#include "bench.hpp"

namespace metier::composition {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::kHead;
using testing::kHeadWithGrip;

constexpr const char* kTwoSteps =
    "[[step]]\nname = \"first\"\nrun = \"a\"\n[[step]]\nname = \"second\"\nrun = \"b\"\n";

/// Mistakes that are found in a file.
std::string problemsOf(const std::string& text) {
    const auto definition = parseDefinition(text, "c.toml");
    return definition ? "nothing" : definition.error().message;
}

TEST(CompositionFile, IsReadAsAWhole) {
    const auto definition =
        loadDefinition(std::string(METIER_COMPOSITIONS_DIR) + "/pick_and_place.toml");
    ASSERT_TRUE(definition) << definition.error().message;
    EXPECT_EQ(definition->name, "PickPlaceSkill");
    EXPECT_EQ(definition->type, "PickPlaceSkillType");
    ASSERT_EQ(definition->parameters.size(), 6U);
    EXPECT_EQ(definition->parameters[2].field.name, "ApproachDistance");
    EXPECT_EQ(definition->parameters[2].field.unit, skill::kMetre);
    EXPECT_EQ(definition->parameters[2].field.range, (skill::Range{0.0, 0.5}));
    EXPECT_EQ(definition->parameters[2].field.default_value, skill::Value(0.1));
    ASSERT_EQ(definition->uses.size(), 5U);
    EXPECT_TRUE(definition->uses[2].reset);
    EXPECT_FALSE(definition->uses[2].optional);
    EXPECT_TRUE(definition->uses[4].optional);
    ASSERT_EQ(definition->root.steps.size(), 7U);
    const auto& take = definition->root.steps[3];
    EXPECT_EQ(take.kind, StepKind::fallback);
    EXPECT_EQ(take.steps[0].retry->times, 1U);
    EXPECT_EQ(*take.steps[0].timeout, std::chrono::seconds(20));
    EXPECT_EQ(take.steps[1].steps.back().kind, StepKind::failure);
    EXPECT_TRUE(definition->root.steps[4].steps[0].background);
}

TEST(CompositionFile, OfTheSquareIsRight) {
    const auto path = std::string(METIER_COMPOSITIONS_DIR) + "/square.toml";
    const auto definition = loadDefinition(path);
    ASSERT_TRUE(definition) << definition.error().message;
    EXPECT_EQ(definition->root.steps[1].kind, StepKind::loop);
    std::ifstream file(path);
    EXPECT_EQ(definition->text, std::string(std::istreambuf_iterator<char>(file), {}));
}

TEST(CompositionFile, KnowsWishesOfUsedSkills) {
    const auto definition = parseDefinition(kHead + R"(
server = "arm"
controller = "UrArm"
reach = 0.6
payload = 1.5
)" + kTwoSteps,
                                            "c.toml");
    ASSERT_TRUE(definition) << definition.error().message;
    EXPECT_EQ(definition->uses[1].server, "arm");
    EXPECT_EQ(definition->uses[1].controller, "UrArm");
    EXPECT_EQ(definition->uses[1].reach, 0.6);
    EXPECT_EQ(definition->uses[1].payload, 1.5);
}

TEST(CompositionFile, TellsEverythingThatIsWrongAtOnceWithItsLine) {
    EXPECT_EQ(problemsOf(R"(name = "A skill"
[parameters.Speed]
type = "nmber"
unit = "m/h"
[uses.a]
type = "MoveSkillType"
resett = true
[[step]]
name = "go"
run = "b"
with.Target = { from = "Sped" }
timeout = -1
)"),
              "c.toml:1: name: \"A skill\" is no name: up to 80 of the letters A to Z and a to z, "
              "digits, _ and -\n"
              "c.toml:1: type: \"A skillType\" is no name: up to 80 of the letters A to Z and a to "
              "z, digits, _ and -\n"
              "c.toml:3: parameters.Speed.type: \"nmber\" is none of: \"boolean\", \"int32\", "
              "\"uint32\", \"uint64\", \"number\", \"text\", \"frame\", \"vector3\", \"numbers\", "
              "\"texts\", \"ranges\", \"frames\"\n"
              "c.toml:4: parameters.Speed.unit: \"m/h\" is none of: \"\", \"m\", \"rad\", \"s\", "
              "\"N\", \"N m\", \"m/s\", \"rad/s\", \"m/s²\", \"rad/s²\", \"kg\"\n"
              "c.toml:5: uses.a: no step runs it\n"
              "c.toml:7: uses.a.resett: unknown key; known here: controller, force, optional, "
              "payload, reach, reset, server, type\n"
              "c.toml:8: step[0].run: \"b\" is not among [uses]: a\n"
              "c.toml:11: step[0].with.Target: there is no parameter \"Sped\"; there are: Speed\n"
              "c.toml:12: step[0].timeout: -1 s is not within 0.001 s to 604800 s");
}

struct Wrong {
    const char* what;
    std::string text;
    const char* problem;
};

class WrongFile : public ::testing::TestWithParam<Wrong> {};

TEST_P(WrongFile, IsRefusedWithItsReason) {
    EXPECT_THAT(problemsOf(GetParam().text), HasSubstr(GetParam().problem));
}

INSTANTIATE_TEST_SUITE_P(
    Each, WrongFile,
    ::testing::Values(
        Wrong{"NoStep", kHead, "a composed skill needs at least one [[step]]"},
        Wrong{"NoName", "[[step]]\nname = \"x\"\nrun = \"a\"\n", "name: missing; needs a text"},
        Wrong{"NoKind", kHead + "[[step]]\nname = \"x\"\n",
              "step[0].run: missing; a step says what it does by one of: run, sequence"},
        Wrong{"TwoKinds",
              kHead + "[[step]]\nname = \"x\"\nrun = \"a\"\n[[step.parallel]]\nname = \"y\"\nrun = "
                      "\"b\"\n",
              "a step that says run cannot say parallel, too"},
        Wrong{"EmptyGroup", kHead + "[[step]]\nname = \"x\"\nsequence = []\n", "has no steps"},
        Wrong{"SameName",
              kHead + "[[step]]\nname = \"x\"\nrun = \"a\"\n[[step]]\nname = \"x\"\nrun = \"b\"\n",
              "c.toml:11: step[1].name: \"x\" is the name of the step at line 8, too"},
        Wrong{"StepCalledExecution", kHead + "[[step]]\nname = \"execution\"\nrun = \"a\"\n",
              "step[0].name: \"execution\" stands for the execution itself"},
        Wrong{"BackgroundAlone", kHead + "[[step]]\nname = \"x\"\nrun = \"a\"\nbackground = true\n",
              "step[0].background: is for some of the steps of a parallel that waits for all"},
        Wrong{"AllInTheBackground",
              kHead + "[[step]]\nname = \"p\"\n[[step.parallel]]\nname = \"x\"\nrun = "
                      "\"a\"\nbackground = true\n",
              "step[0].parallel[0].background: is for some of the steps"},
        Wrong{"ShiftAlongNoAxes",
              kHead + "[[step]]\nname = \"x\"\nrun = \"a\"\nwith.Pose = { from = \"P\", shift = "
                      "[0, 0, 1], shift_axes = \"tool\" }\n",
              "\"tool\" is none of: \"base\", \"own\""},
        Wrong{"ResultOfLaterStep",
              kHead + "[[step]]\nname = \"x\"\nrun = \"a\"\nwith.Target = { from = \"y.Reached\" "
                      "}\n[[step]]\nname = \"y\"\nrun = \"b\"\n",
              "the result of step \"y\" (line 12) is not there yet on every way to here"},
        Wrong{"ResultOfOneBranch", kHeadWithGrip + R"(
[[step]]
name = "g"
run = "grip"
[[step]]
name = "maybe"
if = { from = "g.Held", is = true }
[[step.then]]
name = "x"
run = "a"
[[step]]
name = "y"
run = "b"
with.Target = { from = "x.Reached" }
)",
              "the result of step \"x\""},
        Wrong{"ResultOfAnyBranch", kHeadWithGrip + R"(
[[step]]
name = "either"
wait_for = "any"
[[step.parallel]]
name = "x"
run = "a"
[[step.parallel]]
name = "z"
run = "grip"
[[step]]
name = "y"
run = "b"
with.Target = { from = "x.Reached" }
)",
              "the result of step \"x\""},
        Wrong{"ConditionBeforeTheLoop", kHead + R"(
[[step]]
name = "loop"
at_most = 3
while = { from = "x.Reached", less = 1 }
[[step.repeat]]
name = "x"
run = "a"
[[step.repeat]]
name = "y"
run = "b"
)",
              "step[0].while.from: the result of step \"x\""},
        Wrong{"UnknownStep",
              kHead + "[results.R]\ntype = \"number\"\nfrom = \"q.Reached\"\n" + kTwoSteps,
              "results.R.from: there is no step \"q\""},
        Wrong{"ResultOfAGroup",
              kHead + "[results.R]\ntype = \"number\"\nfrom = \"both.Reached\"\n" +
                  "[[step]]\nname = \"both\"\n[[step.sequence]]\nname = \"first\"\nrun = "
                  "\"a\"\n[[step.sequence]]\nname = \"second\"\nrun = \"b\"\n",
              "step \"both\" runs no skill, so it has no results"},
        Wrong{"LoopWithoutBound", kHead + R"(
[[step]]
name = "loop"
until = { from = "x.Reached", less = 1 }
[[step.repeat]]
name = "x"
run = "a"
[[step.repeat]]
name = "y"
run = "b"
)",
              "step[0].at_most: missing; a loop without times needs the most rounds"},
        Wrong{"LoopWithABoundWithoutRange", kHead + R"(
[parameters.N]
type = "uint32"
[[step]]
name = "loop"
times = { from = "N" }
[[step.repeat]]
name = "x"
run = "a"
[[step.repeat]]
name = "y"
run = "b"
)",
              "step[0].times: has no range, so the loop needs at_most"},
        Wrong{"SameSkillInTwoBranches", kHead + R"(
[[step]]
name = "both"
[[step.parallel]]
name = "x"
run = "a"
[[step.parallel]]
name = "y"
run = "a"
[[step]]
name = "z"
run = "b"
)",
              "\"a\" would run at the same time in \"x\" and \"y\""},
        Wrong{"WaitFor",
              kHead + "[[step]]\nname = \"both\"\nwait_for = \"most\"\n[[step.parallel]]\nname = "
                      "\"x\"\nrun = \"a\"\n[[step.parallel]]\nname = \"y\"\nrun = \"b\"\n",
              "\"most\" is none of: \"all\", \"any\""},
        Wrong{"ComparedWithNothing",
              kHead + "[parameters.N]\ntype = \"uint32\"\n[[step]]\nname = \"maybe\"\nif = { from "
                      "= \"N\" }\n[[step.then]]\nname = \"x\"\nrun = \"a\"\n[[step.else]]\nname = "
                      "\"y\"\nrun = \"b\"\n",
              "is compared with nothing; needs one of: is, less, greater"},
        Wrong{"DefaultOutOfRange",
              kHead +
                  "[parameters.N]\ntype = \"number\"\nunit = \"m\"\nrange = [0, 1]\ndefault = "
                  "2\n" +
                  kTwoSteps,
              "parameters.N.default: N: 2 m is over the limit 1 m"},
        Wrong{"DefaultOfAnotherType",
              kHead + "[parameters.N]\ntype = \"frame\"\ndefault = [1, 2]\n" + kTwoSteps,
              "is not a frame: [x, y, z, a, b, c] in m and rad"},
        Wrong{"Element",
              kHead +
                  "[parameters.N]\ntype = \"frame\"\n[results.R]\ntype = \"number\"\nfrom = "
                  "\"N\"\nelement = \"w\"\n" +
                  kTwoSteps,
              "is not a number from 0, nor one of x, y, z, a, b, c"},
        Wrong{"Binding", kHead + "[[step]]\nname = \"x\"\nrun = \"a\"\nwith.Target = [1, 'b']\n",
              "is neither a constant nor { from"}),
    [](const auto& wrong) { return std::string(wrong.param.what); });

TEST(CompositionFiles, AreSortedByUse) {
    const auto use = [](const std::string& name, const std::string& type) {
        return parseDefinition("name = \"" + name + "\"\n[uses.a]\ntype = \"" + type +
                                   "\"\n[[step]]\nname = \"x\"\nrun = \"a\"\n",
                               name + ".toml")
            .value();
    };
    const auto sorted = inOrderOfUse(
        {use("Outer", "MiddleType"), use("Inner", "MoveSkillType"), use("Middle", "InnerType")});
    ASSERT_TRUE(sorted);
    std::vector<std::string> names;
    for (const auto& definition : *sorted) {
        names.push_back(definition.name);
    }
    EXPECT_THAT(names, ElementsAre("Inner", "Middle", "Outer"));
    const auto around = inOrderOfUse(
        {use("Outer", "MiddleType"), use("Inner", "OuterType"), use("Middle", "InnerType")});
    ASSERT_FALSE(around);
    EXPECT_EQ(around.error().message,
              "Outer.toml: Outer: uses itself: OuterType uses MiddleType uses InnerType uses "
              "OuterType");
    EXPECT_FALSE(inOrderOfUse({use("Same", "MoveSkillType"), use("Same", "MoveSkillType")}));
}

/// Steps that are right, and where the results of steps before are certainly there.
class RightFile : public ::testing::TestWithParam<Wrong> {};

TEST_P(RightFile, IsTaken) {
    EXPECT_EQ(problemsOf(GetParam().text), "nothing");
}

std::string run(const std::string& where, const std::string& name, const std::string& alias,
                const std::string& from = {}) {
    return "[[" + where + "]]\nname = \"" + name + "\"\nrun = \"" + alias + "\"\n" +
           (from.empty() ? "" : "with.Target = { from = \"" + from + ".Reached\" }\n");
}
std::string group(const std::string& name, const std::string& keys = {}) {
    return "[[step]]\nname = \"" + name + "\"\n" + keys;
}
std::string failure(const std::string& where, const std::string& name) {
    return "[[" + where + "]]\nname = \"" + name + "\"\nfail = \"no\"\n";
}

const std::string kLaps =
    "[parameters.Laps]\ntype = \"uint32\"\nrange = [1, 3]\n"
    "[parameters.Maybe]\ntype = \"uint32\"\nrange = [0, 3]\n"
    "[parameters.Ok]\ntype = \"boolean\"\n";

INSTANTIATE_TEST_SUITE_P(
    Each, RightFile,
    ::testing::Values(
        Wrong{"ResultOfBothBranches",
              kHead + group("both") + run("step.parallel", "x", "a") +
                  run("step.parallel", "y", "b") + run("step", "z", "a", "x") +
                  run("step", "w", "b", "y"),
              ""},
        Wrong{"ResultOfTheOnlyWayThatGoesOn",
              kHead + group("either") + run("step.fallback", "x", "a") +
                  failure("step.fallback", "no") + run("step", "z", "b", "x"),
              ""},
        Wrong{"ResultOfTheSecondOfTwoWaysIfTheFirstFails",
              kHead + group("either") + failure("step.fallback", "no") +
                  run("step.fallback", "x", "a") + run("step", "z", "b", "x"),
              ""},
        Wrong{"ResultOfTheWayOfAChoiceThatGoesOn",
              kHead + kLaps + group("maybe", "if = { from = \"Ok\", is = true }\n") +
                  run("step.then", "x", "a") + failure("step.else", "no") +
                  run("step", "z", "b", "x"),
              ""},
        Wrong{"ResultWithinItsLoop",
              kHead + group("loop", "times = 3\n") + run("step.repeat", "x", "a") +
                  run("step.repeat", "y", "b", "x"),
              ""},
        Wrong{"ResultAfterALoopOfAtLeastOneRound",
              kHead + kLaps + group("loop", "times = { from = \"Laps\" }\n") +
                  run("step.repeat", "x", "a") + run("step", "y", "b", "x"),
              ""},
        Wrong{"ResultInTheConditionAfterARound",
              kHead + group("loop", "at_most = 3\nuntil = { from = \"x.Reached\", less = 1 }\n") +
                  run("step.repeat", "x", "a") + run("step", "y", "b", "x"),
              ""},
        Wrong{"AnythingAfterAFailure",
              kHead + failure("step", "no") + run("step", "x", "a", "y") + run("step", "y", "b"),
              ""},
        Wrong{"NameOfAllKindsOfLetters",
              kHead + run("step", "aZ09_-zA", "a") + run("step", std::string(40, 'x'), "b"), ""},
        Wrong{"Times",
              kHead + "[[step]]\nname = \"x\"\nrun = \"a\"\ntimeout = 0.001\nretry = 1000\n"
                      "pause = 604800\n[[step]]\nname = \"y\"\nrun = \"b\"\ntimeout = 604800\n",
              ""},
        Wrong{"MostRounds",
              kHead + group("loop", "at_most = 1000000\ntimes = 3\n") +
                  run("step.repeat", "x", "a") + run("step", "y", "b"),
              ""},
        Wrong{"Lengths",
              kHead +
                  "[parameters.A]\ntype = \"numbers\"\nlength = 0\n[parameters.B]\ntype = "
                  "\"numbers\"\nlength = [2, 2]\n[parameters.C]\ntype = \"number\"\nrange = "
                  "[1, 1]\n" +
                  kTwoSteps,
              ""}),
    [](const auto& right) { return std::string(right.param.what); });

INSTANTIATE_TEST_SUITE_P(
    More, WrongFile,
    ::testing::Values(
        Wrong{"ResultOfASisterBranch",
              kHead + group("both") + run("step.parallel", "x", "a") +
                  run("step.parallel", "y", "b", "x"),
              "step[0].parallel[1].with.Target: the result of step \"x\" (line 10) is not there "
              "yet on every way to here"},
        Wrong{"ResultOfABackgroundStep",
              kHeadWithGrip + group("both") + run("step.parallel", "x", "a") +
                  "background = true\n" +
                  "[[step.parallel]]\nname = \"g\"\nrun = \"grip\"\nwith.Force = 1\n" +
                  run("step", "y", "b", "x"),
              "step[1].with.Target: the result of step \"x\""},
        Wrong{"ResultOfAnAlternativeThatFailed",
              kHead + group("either") + run("step.fallback", "x", "a") +
                  run("step.fallback", "y", "b", "x"),
              "step[0].fallback[1].with.Target: the result of step \"x\""},
        Wrong{"ResultOfOneAlternative",
              kHead + group("either") + run("step.fallback", "x", "a") +
                  run("step.fallback", "y", "b") + run("step", "z", "a", "x"),
              "step[1].with.Target: the result of step \"x\""},
        Wrong{"ResultOfTheOtherWayOfAChoice",
              kHead + kLaps + group("maybe", "if = { from = \"Ok\", is = true }\n") +
                  run("step.then", "x", "a") + run("step.else", "y", "b", "x"),
              "step[0].else[0].with.Target: the result of step \"x\""},
        Wrong{"ResultAfterALoopOfMaybeNoRound",
              kHead + kLaps + group("loop", "times = { from = \"Maybe\" }\n") +
                  run("step.repeat", "x", "a") + run("step", "y", "b", "x"),
              "step[1].with.Target: the result of step \"x\""},
        Wrong{"ResultAfterALoopWithACondition",
              kHead + kLaps + group("loop", "at_most = 2\nwhile = { from = \"Ok\", is = true }\n") +
                  run("step.repeat", "x", "a") + run("step", "y", "b", "x"),
              "step[1].with.Target: the result of step \"x\""},
        Wrong{"ResultAfterAnAlternativeThatFails",
              kHead + group("either") + failure("step.fallback", "no") +
                  run("step.fallback", "x", "a", "y") + run("step", "y", "b"),
              "step[0].fallback[1].with.Target: the result of step \"y\""},
        Wrong{"ResultAfterTwoFailuresOfOneAlternative",
              kHead +
                  "[[step]]\nname = \"either\"\n[[step.fallback]]\nname = "
                  "\"twice\"\n[[step.fallback.sequence]]\nname = \"no\"\nfail = "
                  "\"no\"\n[[step.fallback.sequence]]\nname = \"never\"\nfail = \"no\"\n" +
                  run("step.fallback", "x", "a", "y") + run("step", "y", "b"),
              "step[0].fallback[1].with.Target: the result of step \"y\""},
        Wrong{"ResultInAShift",
              kHead +
                  "[[step]]\nname = \"x\"\nrun = \"a\"\nwith.Target = { from = \"N\", shift = "
                  "{ from = \"y.Reached\" } }\n" +
                  run("step", "y", "b"),
              "the result of step \"y\""},
        Wrong{"ResultInAList",
              kHead +
                  "[[step]]\nname = \"x\"\nrun = \"a\"\nwith.Joints = [1, { from = "
                  "\"y.Reached\" }]\n" +
                  run("step", "y", "b"),
              "the result of step \"y\""},
        Wrong{"ResultInTheOperandOfACondition",
              kHead + kLaps +
                  group("maybe",
                        "if = { not = { from = \"Laps\", less = { from = \"y.Reached\" } "
                        "} }\n") +
                  run("step.then", "x", "a") + run("step", "y", "b"),
              "step[0].if.not.less: the result of step \"y\""},
        Wrong{"RoundsOfAnUnknownParameter",
              kHead + group("loop", "at_most = 2\ntimes = { from = \"Lap\" }\n") +
                  run("step.repeat", "x", "a") + run("step", "y", "b"),
              "step[0].times: there is no parameter \"Lap\""},
        Wrong{"RoundsOfAResultWithoutABound",
              kHead + run("step", "x", "a") + group("loop", "times = { from = \"x.Reached\" }\n") +
                  run("step.repeat", "y", "b"),
              "step[1].times: has no range, so the loop needs at_most"},
        Wrong{"BackgroundOfAParallelThatWaitsForAny",
              kHead + group("both", "wait_for = \"any\"\n") + run("step.parallel", "x", "a") +
                  "background = true\n" + run("step.parallel", "y", "b"),
              "step[0].parallel[0].background: is for some of the steps"},
        Wrong{"BackgroundOfASequence",
              kHead + group("both") + run("step.sequence", "x", "a") + "background = true\n" +
                  run("step.sequence", "y", "b"),
              "step[0].sequence[0].background: is for some of the steps"},
        Wrong{"BackgroundOfAnElse",
              kHead + kLaps + group("maybe", "if = { from = \"Ok\", is = true }\n") +
                  run("step.then", "x", "a") + run("step.else", "y", "b") + "background = true\n",
              "step[0].else[0].background: is for some of the steps"},
        Wrong{"NameTooLong", kHead + run("step", std::string(41, 'x'), "a"),
              "is no name: up to 40 of the letters"},
        Wrong{"NameWithABracket", kHead + run("step", "x[1]", "a"), "\"x[1]\" is no name"},
        Wrong{"NameWithAnAt", kHead + run("step", "x@", "a"), "\"x@\" is no name"},
        Wrong{"NameWithABackTick", kHead + run("step", "x`", "a"), "\"x`\" is no name"},
        Wrong{"NameWithABrace", kHead + run("step", "x{", "a"), "\"x{\" is no name"},
        Wrong{"NameWithASlash", kHead + run("step", "x/", "a"), "\"x/\" is no name"},
        Wrong{"NameWithAColon", kHead + run("step", "x:", "a"), "\"x:\" is no name"},
        Wrong{"NameOfAParameter", kHead + "[parameters.\"a b\"]\ntype = \"number\"\n" + kTwoSteps,
              "\"a b\" is no name: up to 80"},
        Wrong{"TimeoutOfNothing",
              kHead + run("step", "x", "a") + "timeout = 0\n" + run("step", "y", "b"),
              "0 s is not within 0.001 s to 604800 s"},
        Wrong{"TimeoutOverAWeek",
              kHead + run("step", "x", "a") + "timeout = 604801\n" + run("step", "y", "b"),
              "604801 s is not within 0.001 s to 604800 s"},
        Wrong{"PauseBelowZero",
              kHead + run("step", "x", "a") + "retry = 1\npause = -1\n" + run("step", "y", "b"),
              "-1 s is not within 0 s to 604800 s"},
        Wrong{"NoRetry", kHead + run("step", "x", "a") + "retry = 0\n" + run("step", "y", "b"),
              "step[0].retry"},
        Wrong{"TooManyRetries",
              kHead + run("step", "x", "a") + "retry = 1001\n" + run("step", "y", "b"),
              "step[0].retry"},
        Wrong{"TooManyRounds",
              kHead + group("loop", "at_most = 1000001\n") + run("step.repeat", "x", "a") +
                  run("step", "y", "b"),
              "step[0].at_most"},
        Wrong{"RestTimeOfNothing", "rest_time = 0\n" + std::string("name = \"T\"\n") + kTwoSteps,
              "rest_time: 0 s is not over 0 and up to 3600 s"},
        Wrong{"RestTimeOverAnHour",
              "rest_time = 3601\n" + std::string("name = \"T\"\n") + kTwoSteps,
              "rest_time: 3601 s is not over 0 and up to 3600 s"},
        Wrong{"OwnerLoss", "on_owner_loss = \"stop\"\n" + std::string("name = \"T\"\n") + kTwoSteps,
              "\"stop\" is none of: \"halt\", \"suspend\", \"continue\""},
        Wrong{"LengthBelowZero",
              kHead + "[parameters.N]\ntype = \"numbers\"\nlength = -1\n" + kTwoSteps,
              "is not a number of elements, nor [least, most]"},
        Wrong{"LengthThatFalls",
              kHead + "[parameters.N]\ntype = \"numbers\"\nlength = [3, 2]\n" + kTwoSteps,
              "is not a number of elements, nor [least, most]"},
        Wrong{"LengthOfThree",
              kHead + "[parameters.N]\ntype = \"numbers\"\nlength = [1, 2, 3]\n" + kTwoSteps,
              "is not a number of elements, nor [least, most]"},
        Wrong{"LengthWithATextAsItsMost",
              kHead + "[parameters.N]\ntype = \"numbers\"\nlength = [1, \"2\"]\n" + kTwoSteps,
              "is not a number of elements, nor [least, most]"},
        Wrong{"RangeOfOne", kHead + "[parameters.N]\ntype = \"number\"\nrange = [1]\n" + kTwoSteps,
              "parameters.N.range: is not [lowest, highest]"},
        Wrong{"RangeThatFalls",
              kHead + "[parameters.N]\ntype = \"number\"\nrange = [2, 1]\n" + kTwoSteps,
              "parameters.N.range: is not [lowest, highest]"},
        Wrong{"RangeOfAFrame",
              kHead + "[parameters.N]\ntype = \"frame\"\nrange = [1, 2]\n" + kTwoSteps,
              "parameters.N.range: frames have none"},
        Wrong{"RangeOfFrames",
              kHead + "[parameters.N]\ntype = \"frames\"\nrange = [1, 2]\n" + kTwoSteps,
              "parameters.N.range: frames have none"},
        Wrong{"DefaultThatIsNoConstant",
              kHead + "[parameters.N]\ntype = \"number\"\ndefault = { from = \"M\" }\n" + kTwoSteps,
              "parameters.N.default: is no constant"},
        Wrong{"ReferenceWithoutAStep",
              kHead +
                  "[[step]]\nname = \"x\"\nrun = \"a\"\nwith.Target = { from = \".Reached\" "
                  "}\n" +
                  run("step", "y", "b"),
              "\".Reached\" is neither a parameter nor \"step.Result\""},
        Wrong{"ReferenceWithoutAResult",
              kHead + run("step", "y", "b") +
                  "[[step]]\nname = \"x\"\nrun = \"a\"\nwith.Target = { from = \"y.\" }\n",
              "\"y.\" is neither a parameter nor \"step.Result\""},
        Wrong{"ElementBelowZero",
              kHead + run("step", "y", "b") +
                  "[[step]]\nname = \"x\"\nrun = \"a\"\nwith.Target = { from = \"y.ReachedPose\", "
                  "element = -1 }\n",
              "is not a number from 0, nor one of x, y, z, a, b, c"},
        Wrong{"TermOfAText",
              kHead + run("step", "y", "b") +
                  "[[step]]\nname = \"x\"\nrun = \"a\"\nwith.Joints = [\"1\", { from = "
                  "\"y.Reached\" }]\n",
              "is neither a number nor { from = "},
        Wrong{"EmptyThen",
              kHead + kLaps + group("maybe", "if = { from = \"Ok\", is = true }\nthen = []\n") +
                  kTwoSteps,
              "step[0].then: has no steps"}),
    [](const auto& wrong) { return std::string(wrong.param.what); });

/// The definition of a file that is right.
Definition definitionOf(const std::string& text) {
    auto definition = parseDefinition(text, "c.toml");
    EXPECT_TRUE(definition) << definition.error().message;
    return definition ? std::move(*definition) : Definition{};
}

TEST(CompositionFile, MayNameElementsByLetterOrNumber) {
    for (const auto& [element, index] :
         {std::pair("\"x\"", 0U), std::pair("\"y\"", 1U), std::pair("\"z\"", 2U),
          std::pair("\"a\"", 3U), std::pair("\"b\"", 4U), std::pair("\"c\"", 5U),
          std::pair("0", 0U), std::pair("7", 7U)}) {
        const auto definition =
            definitionOf(kHead + run("step", "y", "b") +
                         "[[step]]\nname = \"x\"\nrun = \"a\"\nwith.Target = { from = "
                         "\"y.ReachedPose\", element = " +
                         element + " }\n");
        ASSERT_EQ(definition.root.steps.size(), 2U);
        const auto& value = definition.root.steps[1].arguments.at(0).value;
        const auto& reference = std::get<Reference>(value.source);
        EXPECT_EQ(reference.step, "y");
        EXPECT_EQ(reference.name, "ReachedPose");
        EXPECT_EQ(reference.element, index);
    }
}

TEST(CompositionFile, HasDefaultsForWhatItDoesNotSay) {
    const auto definition = definitionOf(
        "name = \"T\"\n[uses.a]\ntype = \"MoveSkillType\"\n[parameters.N]\ntype = \"number\"\n"
        "[[step]]\nname = \"x\"\nrun = \"a\"\nretry = 2\n");
    EXPECT_EQ(definition.type, "TType");
    EXPECT_EQ(definition.rest_time, std::chrono::seconds(6));
    EXPECT_EQ(definition.on_owner_loss, skill::OwnerLossAction::halt);
    EXPECT_FALSE(definition.parameters[0].field.optional);
    EXPECT_FALSE(definition.parameters[0].field.range);
    EXPECT_FALSE(definition.parameters[0].field.length);
    EXPECT_EQ(definition.parameters[0].field.unit, skill::kOne);
    EXPECT_FALSE(definition.uses[0].reset);
    EXPECT_FALSE(definition.uses[0].reach);
    EXPECT_EQ(definition.root.steps[0].retry->times, 2U);
    EXPECT_EQ(definition.root.steps[0].retry->pause, std::chrono::seconds(0));
    EXPECT_FALSE(definition.root.steps[0].timeout);
    EXPECT_FALSE(definition.root.steps[0].background);
    EXPECT_EQ(restDeadlineOf(definition), std::chrono::seconds(13));
}

TEST(CompositionFile, KeepsWhatItSaysOfFieldsAndTimes) {
    const auto definition = definitionOf(
        "name = \"T\"\ntype = \"OtherType\"\nrest_time = 0.5\non_owner_loss = \"continue\"\n"
        "[uses.a]\ntype = \"MoveSkillType\"\n"
        "[parameters.N]\ntype = \"numbers\"\nunit = \"rad/s\"\nrange = [-1, 2]\nlength = [1, "
        "3]\noptional = true\n"
        "[parameters.Six]\ntype = \"numbers\"\nlength = 6\n"
        "[results.R]\ntype = \"number\"\nfrom = \"x.ReachedPose\"\nelement = \"z\"\n"
        "[[step]]\nname = \"x\"\nrun = \"a\"\ntimeout = 2.5\nretry = 1\npause = 0.25\n");
    EXPECT_EQ(definition.type, "OtherType");
    EXPECT_EQ(definition.rest_time, std::chrono::milliseconds(500));
    EXPECT_EQ(definition.on_owner_loss, skill::OwnerLossAction::keep_going);
    const auto& field = definition.parameters[0].field;
    EXPECT_EQ(field.unit, skill::kRadianPerSecond);
    EXPECT_EQ(field.range, (skill::Range{-1, 2}));
    EXPECT_EQ(field.length->least, 1U);
    EXPECT_EQ(field.length->most, 3U);
    EXPECT_TRUE(field.optional);
    EXPECT_EQ(definition.parameters[1].field.length->least, 6U);
    EXPECT_EQ(definition.parameters[1].field.length->most, 6U);
    EXPECT_EQ(definition.results[0].field.place, skill::Place::final_result);
    EXPECT_EQ(std::get<Reference>(definition.results[0].from.source).element, 2U);
    EXPECT_EQ(definition.root.steps[0].timeout, std::chrono::milliseconds(2500));
    EXPECT_EQ(definition.root.steps[0].retry->pause, std::chrono::milliseconds(250));
}

TEST(CompositionFiles, MayNotDeclareOneTypeTwice) {
    const auto definition = [](const std::string& name, const std::string& type) {
        return definitionOf("name = \"" + name + "\"\ntype = \"" + type +
                            "\"\n[uses.a]\ntype = \"MoveSkillType\"\n[[step]]\nname = "
                            "\"x\"\nrun = \"a\"\n");
    };
    EXPECT_EQ(inOrderOfUse({definition("One", "SameType"), definition("Two", "SameType")})
                  .error()
                  .message,
              "c.toml and c.toml both declare SameType");
    EXPECT_EQ(inOrderOfUse({definition("Same", "OneType"), definition("Same", "TwoType")})
                  .error()
                  .message,
              "c.toml and c.toml both declare Same");
    EXPECT_EQ(inOrderOfUse({definition("One", "OneType"), definition("Two", "TwoType")})->size(),
              2U);
}

TEST(CompositionFile, ThatIsNoTomlOrNotThereIsRefusedByItsName) {
    EXPECT_THAT(problemsOf("name = \n"), HasSubstr("c.toml:1"));
    const auto missing = loadDefinition("/none/there.toml");
    ASSERT_FALSE(missing);
    EXPECT_THAT(missing.error().message, HasSubstr("/none/there.toml"));
}

}  // namespace
}  // namespace metier::composition
