#include "metier/composition/definition_file.hpp"

#include <gmock/gmock.h>

#include "bench.hpp"

namespace metier::composition {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::kHead;
using testing::kHeadWithGrip;

constexpr const char* kTwoSteps =
    "[[step]]\nname = \"first\"\nrun = \"a\"\n[[step]]\nname = \"second\"\nrun = \"b\"\n";

/// What is wrong with a file.
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
    ASSERT_EQ(definition->root.steps.size(), 7U);
    const auto& take = definition->root.steps[3];
    EXPECT_EQ(take.kind, StepKind::fallback);
    EXPECT_EQ(take.steps[0].retry->times, 1U);
    EXPECT_EQ(*take.steps[0].timeout, std::chrono::seconds(20));
    EXPECT_EQ(take.steps[1].steps.back().kind, StepKind::failure);
    EXPECT_TRUE(definition->root.steps[4].steps[0].background);
}

TEST(CompositionFile, OfTheSquareIsRight) {
    const auto definition = loadDefinition(std::string(METIER_COMPOSITIONS_DIR) + "/square.toml");
    ASSERT_TRUE(definition) << definition.error().message;
    EXPECT_EQ(definition->root.steps[1].kind, StepKind::loop);
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
              "c.toml:7: uses.a.resett: unknown key; known here: controller, payload, reach, "
              "reset, server, type\n"
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

}  // namespace
}  // namespace metier::composition
