// Bindings against the skills that are really there.
#include "metier/composition/composition.hpp"

#include <gmock/gmock.h>

#include "bench.hpp"

namespace metier::composition {
namespace {

using testing::graspDescription;
using ::testing::HasSubstr;
using testing::kHeadWithGrip;
using testing::moveDescription;

std::string problemsOf(const std::string& text) {
    auto definition = parseDefinition(kHeadWithGrip + text, "c.toml");
    if (!definition) {
        return "the file: " + definition.error().message;
    }
    const auto composition =
        compose(std::move(*definition),
                {{"a", moveDescription()}, {"b", moveDescription()}, {"grip", graspDescription()}});
    return composition ? "nothing" : composition.error().message;
}

/// A file whose last step is to be looked at.
std::string withStep(const std::string& with) {
    return R"(
[parameters.Force]
type = "number"
unit = "N"
[parameters.Pose]
type = "frame"
[parameters.Three]
type = "numbers"
length = 3
[[step]]
name = "grasp"
run = "grip"
with.Force = 10
[[step]]
name = "first"
run = "a"
[[step]]
name = "last"
run = "b"
)" + with;
}

TEST(Compose, AcceptsWhatFits) {
    EXPECT_EQ(problemsOf(withStep("with.Target = { from = \"grasp.Width\" }\n"
                                  "with.Pose = { from = \"first.ReachedPose\" }\n")),
              "nothing");
}

TEST(Compose, TellsTheDescriptionOfTheComposedSkill) {
    const auto definition =
        parseDefinition(kHeadWithGrip + "on_owner_loss = \"suspend\"\n" + withStep(""), "c.toml");
    ASSERT_FALSE(definition) << "a key of [uses.grip]";
    const auto right = parseDefinition(
        "on_owner_loss = \"suspend\"\ndescription = \"Tests.\"\n" + kHeadWithGrip + withStep(""),
        "c.toml");
    ASSERT_TRUE(right) << right.error().message;
    const auto description = descriptionOf(*right);
    EXPECT_EQ(description.name, "TestSkill");
    EXPECT_EQ(description.type, "TestSkillType");
    EXPECT_EQ(description.description, "Tests.");
    EXPECT_EQ(description.on_owner_loss, skill::OwnerLossAction::suspend);
    EXPECT_EQ(description.parameters.size(), 3U);
}

struct Misfit {
    const char* what;
    std::string with;
    const char* problem;
};

class MisfitBinding : public ::testing::TestWithParam<Misfit> {};

TEST_P(MisfitBinding, IsToldWithItsLine) {
    const auto problems = problemsOf(withStep(GetParam().with));
    EXPECT_THAT(problems, HasSubstr("c.toml:30: "));
    EXPECT_THAT(problems, HasSubstr(GetParam().problem));
}

INSTANTIATE_TEST_SUITE_P(
    Each, MisfitBinding,
    ::testing::Values(
        Misfit{"UnknownParameter", "with.Goal = 1\n",
               "step[2].with.Goal: MoveSkill has no such parameter; it has: Target, Pose, Joints"},
        Misfit{"ConstantOfAnotherType", "with.Target = \"far\"\n",
               "step[2].with.Target: is not a number"},
        Misfit{"ConstantOutOfRange", "with.Target = 11\n", "Target: 11 m is over the limit 10 m"},
        Misfit{"ConstantOfWrongLength", "with.Joints = [1, 2, 3]\n",
               "Joints: 3 elements are more than 2"},
        Misfit{"TypeOfAParameter", "with.Target = { from = \"Pose\" }\n",
               "Pose is of type frame, Target needs number"},
        Misfit{"UnitOfAParameter", "with.Target = { from = \"Force\" }\n",
               "Force is in N, Target needs m"},
        Misfit{"LengthOfAParameter", "with.Joints = { from = \"Three\" }\n",
               "Three has 3 to 3 elements, Joints needs 2 to 2"},
        Misfit{"UnknownResult", "with.Target = { from = \"grasp.Depth\" }\n",
               "GraspSkill has no result \"Depth\"; it has: Width, Held"},
        Misfit{"NoElements", "with.Target = { from = \"grasp.Width\", element = 0 }\n",
               "Width is of type number, which has no elements"},
        Misfit{"ElementBeyond", "with.Target = { from = \"Three\", element = 3 }\n",
               "Three has no element 3; it has 3"},
        Misfit{"ShiftOfWrongLength", "with.Pose = { from = \"Pose\", shift = [1, 2] }\n",
               "shift has 2 numbers; Pose needs 3"},
        Misfit{"ShiftByNoNumber",
               "with.Target = { from = \"grasp.Width\", shift = { from = \"Pose\" } }\n",
               "Pose is of type frame, a number is needed"},
        Misfit{"TermsOfWrongLength", "with.Pose = [1, { from = \"Force\" }]\n",
               "has 2 numbers; Pose needs a frame"}),
    [](const auto& misfit) { return std::string(misfit.param.what); });

TEST(Compose, TellsWhatACallLacks) {
    EXPECT_THAT(problemsOf("[[step]]\nname = \"x\"\nrun = \"grip\"\n[[step]]\nname = \"y\"\nrun = "
                           "\"a\"\n[[step]]\nname = \"z\"\nrun = \"b\"\n"),
                HasSubstr("step[0].with: Force of GraspSkill needs a value"));
}

TEST(Compose, TellsConditionsThatCannotBe) {
    const std::string rest =
        "[[step.then]]\nname = \"y\"\nrun = \"a\"\n[[step]]\nname = \"z\"\nrun "
        "= \"b\"\n";
    const std::string grasp = "[[step]]\nname = \"x\"\nrun = \"grip\"\nwith.Force = 1\n";
    EXPECT_THAT(
        problemsOf(grasp + "[[step]]\nname = \"q\"\nif = { from = \"x.Held\", less = 1 }\n" + rest),
        HasSubstr("Held is no number, so it is neither less nor greater"));
    EXPECT_THAT(
        problemsOf(grasp + "[[step]]\nname = \"q\"\nif = { from = \"x.Held\", is = 1 }\n" + rest),
        HasSubstr("step[1].if.is: is not true or false"));
}

TEST(Compose, TellsASkillThatNothingServes) {
    auto definition = parseDefinition(kHeadWithGrip + withStep(""), "c.toml");
    ASSERT_TRUE(definition);
    const auto composition =
        compose(std::move(*definition), {{"a", moveDescription()}, {"b", moveDescription()}});
    ASSERT_FALSE(composition);
    EXPECT_THAT(composition.error().message, HasSubstr("no skill serves \"grip\""));
}

/// Declarations of every type, and steps whose last one is to be looked at.
std::string withAllTypes(const std::string& last) {
    return R"(
[parameters.I]
type = "int32"
range = [1, 9]
[parameters.D]
type = "number"
[parameters.Length]
type = "number"
unit = "m"
[parameters.T]
type = "text"
[parameters.Pose]
type = "frame"
[parameters.Poses]
type = "frames"
[parameters.Names]
type = "texts"
[parameters.Vector]
type = "vector3"
[parameters.List]
type = "numbers"
[parameters.UpToTwo]
type = "numbers"
length = [1, 2]
[parameters.FromTwo]
type = "numbers"
length = [2, 9]
[[step]]
name = "grasp"
run = "grip"
with.Force = 10
[[step]]
name = "first"
run = "a"
)" + last;
}

TEST(Compose, AcceptsEveryValueThatFits) {
    for (const auto* with :
         {"with.Target = { from = \"D\" }", "with.Target = { from = \"Length\" }",
          "with.Target = { from = \"Pose\", element = 5 }",
          "with.Target = { from = \"Vector\", element = 2 }",
          "with.Target = { from = \"List\", element = 99 }",
          "with.Target = { from = \"UpToTwo\", element = 1 }",
          "with.Target = { from = \"D\", shift = 1 }",
          "with.Pose = { from = \"Poses\", element = 3 }",
          "with.Pose = { from = \"Pose\", shift = [1, 2, 3], shift_axes = \"own\" }",
          "with.Pose = [1, 2, 3, { from = \"D\" }, 0, 0]", "with.Joints = [{ from = \"D\" }, 1]",
          "with.Joints = { from = \"List\" }", "with.Joints = { from = \"UpToTwo\" }",
          "with.Joints = { from = \"FromTwo\" }",
          "with.Joints = { from = \"List\", shift = [1, 2] }"}) {
        EXPECT_EQ(problemsOf(withAllTypes("[[step]]\nname = \"last\"\nrun = \"b\"\n" +
                                          std::string(with) + "\n")),
                  "nothing")
            << with;
    }
}

TEST(Compose, TellsEveryValueThatDoesNotFit) {
    struct Case {
        const char* with;
        const char* problem;
    };
    for (const auto& [with, problem] :
         {Case{"with.Target = { from = \"I\" }", "I is of type int32, Target needs number"},
          Case{"with.Target = { from = \"Pose\", element = 6 }", "Pose has no element 6; it has 6"},
          Case{"with.Target = { from = \"Vector\", element = 3 }",
               "Vector has no element 3; it has 3"},
          Case{"with.Target = { from = \"UpToTwo\", element = 2 }",
               "UpToTwo has no element 2; it has 2"},
          Case{"with.Target = { from = \"Names\", element = 0 }",
               "Names[0] is of type text, Target needs number"},
          Case{"with.Target = { from = \"T\", element = 0 }",
               "T is of type text, which has no elements"},
          Case{"with.Target = [1, { from = \"D\" }]",
               "is a list of numbers; Target needs a number"},
          Case{"with.Target = { from = \"D\", shift = [1, 2] }",
               "shift has 2 numbers; Target needs 1"},
          Case{"with.Target = { from = \"D\", shift = 1, shift_axes = \"own\" }",
               "Target is of type number, which has no axes of its own"},
          Case{"with.Pose = [1, 2, { from = \"D\" }]", "has 3 numbers; Pose needs a frame"},
          Case{"with.Pose = [1, 2, 3, 4, 5, { from = \"T\" }]",
               "T is of type text, a number is needed"},
          Case{"with.Pose = { from = \"Pose\", shift = [1, 2, 3, 4] }",
               "shift has 4 numbers; Pose needs 3"}}) {
        EXPECT_THAT(problemsOf(withAllTypes("[[step]]\nname = \"last\"\nrun = \"b\"\n" +
                                            std::string(with) + "\n")),
                    HasSubstr(problem));
    }
}

TEST(Compose, TakesLengthsThatMayFitAndRefusesThoseThatCannot) {
    const auto with = [](const std::string& length) {
        return problemsOf(
            "[parameters.N]\ntype = \"numbers\"\nlength = " + length +
            "\n[[step]]\nname = \"g\"\nrun = \"grip\"\nwith.Force = 1\n[[step]]\nname "
            "= \"x\"\nrun = \"a\"\nwith.Joints = { from = \"N\" }\n[[step]]\nname = "
            "\"y\"\nrun = \"b\"\n");
    };
    EXPECT_EQ(with("[0, 2]"), "nothing");
    EXPECT_EQ(with("[2, 9]"), "nothing");
    EXPECT_THAT(with("[0, 1]"), HasSubstr("N has 0 to 1 elements, Joints needs 2 to 2"));
    EXPECT_THAT(with("[3, 9]"), HasSubstr("N has 3 to 9 elements, Joints needs 2 to 2"));
}

/// A loop of so many rounds, after steps that run everything.
std::string loopOf(const std::string& times) {
    return withAllTypes("[[step]]\nname = \"loop\"\nat_most = 9\ntimes = " + times +
                        "\n[[step.repeat]]\nname = \"last\"\nrun = \"b\"\n");
}

TEST(Compose, CountsRoundsWithANumberOfAnyType) {
    EXPECT_EQ(problemsOf(loopOf("3")), "nothing");
    EXPECT_EQ(problemsOf(loopOf("{ from = \"I\" }")), "nothing");
    EXPECT_EQ(problemsOf(loopOf("{ from = \"D\" }")), "nothing");
    EXPECT_EQ(problemsOf(loopOf("{ from = \"grasp.Width\" }")), "nothing");
    EXPECT_THAT(problemsOf(loopOf("{ from = \"T\" }")),
                HasSubstr("T is of type text, times needs number"));
    EXPECT_THAT(problemsOf(loopOf("\"often\"")), HasSubstr("times: is not a number"));
}

TEST(Compose, LooksAtEveryConditionOfAStep) {
    const auto conditioned = [](const std::string& condition) {
        return problemsOf(withAllTypes(
            "[[step]]\nname = \"loop\"\nat_most = 9\nwhile = " + condition +
            "\nuntil = " + condition + "\n[[step.repeat]]\nname = \"last\"\nrun = \"b\"\n"));
    };
    EXPECT_EQ(conditioned("{ from = \"I\", less = 100 }"), "nothing") << "beyond its range";
    EXPECT_EQ(conditioned("{ from = \"Length\", greater = { from = \"D\" } }"), "nothing");
    for (const auto* bad :
         {"{ from = \"T\", less = 1 }", "{ not = { from = \"T\", less = 1 } }",
          "{ all = [{ from = \"I\", is = 1 }, { from = \"T\", less = 1 }] }",
          "{ any = [{ from = \"T\", greater = 1 }, { from = \"I\", is = 1 }] }"}) {
        const auto problems = conditioned(bad);
        EXPECT_THAT(problems, HasSubstr("step[2].while")) << bad;
        EXPECT_THAT(problems, HasSubstr("step[2].until")) << bad;
        EXPECT_THAT(problems, HasSubstr("T is no number, so it is neither less nor greater"));
    }
}

TEST(Compose, LooksAtResultsAndWithinBothWaysOfAChoice) {
    EXPECT_THAT(
        problemsOf("[results.R]\ntype = \"number\"\nunit = \"N\"\nfrom = \"first.Reached\"\n" +
                   withAllTypes("[[step]]\nname = \"last\"\nrun = \"b\"\n")),
        HasSubstr("results.R.from: Reached is in m, R needs N"));
    EXPECT_THAT(problemsOf("[results.R]\ntype = \"number\"\nfrom = \"execution.Time\"\n" +
                           withAllTypes("[[step]]\nname = \"last\"\nrun = \"b\"\n")),
                HasSubstr("an execution has no \"Time\"; it has: Steps, Durations"));
    const auto problems = problemsOf(withAllTypes(
        "[[step]]\nname = \"maybe\"\nif = { from = \"I\", is = 1 }\n[[step.then]]\nname = "
        "\"yes\"\nrun = \"b\"\nwith.Target = 11\n[[step.else]]\nname = \"no\"\nrun = "
        "\"a\"\nwith.Target = 12\n"));
    EXPECT_THAT(problems, HasSubstr("step[2].then[0].with.Target: Target: 11 m is over"));
    EXPECT_THAT(problems, HasSubstr("step[2].else[0].with.Target: Target: 12 m is over"));
}

TEST(Compose, TellsProblemsInTheOrderOfTheirLines) {
    const auto problems =
        problemsOf("[results.R]\ntype = \"number\"\nunit = \"N\"\nfrom = \"first.Reached\"\n" +
                   withAllTypes("[[step]]\nname = \"last\"\nrun = \"b\"\nwith.Target = 11\n"));
    EXPECT_LT(problems.find("results.R"), problems.find("with.Target"));
    EXPECT_NE(problems.find("\nc.toml:"), std::string::npos) << "a line each";
}

TEST(Compose, NamesAllStepsOfTheComposedSkill) {
    const auto definition = parseDefinition(
        kHeadWithGrip + withAllTypes("[[step]]\nname = \"maybe\"\nif = { from = \"I\", is = 1 "
                                     "}\n[[step.then]]\nname = \"yes\"\nrun = "
                                     "\"b\"\n[[step.else]]\nname = \"no\"\nrun = \"a\"\n"),
        "c.toml");
    ASSERT_TRUE(definition) << definition.error().message;
    EXPECT_EQ(descriptionOf(*definition).steps,
              (std::vector<std::string>{"grasp", "first", "maybe", "yes", "no"}));
}

/// A skill with one parameter of that type, which is given this constant.
std::string problemsOfConstant(skill::ValueType type, const std::string& constant) {
    auto definition = parseDefinition(
        "name = \"T\"\n[uses.a]\ntype = \"ASkillType\"\n[[step]]\nname = \"x\"\nrun = "
        "\"a\"\nwith.P = " +
            constant + "\n",
        "c.toml");
    if (!definition) {
        return definition.error().message;
    }
    const auto composed =
        compose(std::move(*definition),
                {{"a", {.name = "ASkill", .parameters = {{.name = "P", .type = type}}}}});
    return composed
               ? skill::toString(composed->definition.root.steps[0].arguments[0].value.constant)
               : composed.error().message;
}

TEST(Constant, BecomesAValueOfTheTypeThatItsParameterHas) {
    using skill::ValueType;
    EXPECT_EQ(problemsOfConstant(ValueType::boolean, "true"), "true");
    EXPECT_EQ(problemsOfConstant(ValueType::int32, "-7"), "-7");
    EXPECT_EQ(problemsOfConstant(ValueType::uint32, "4294967295"), "4294967295");
    EXPECT_EQ(problemsOfConstant(ValueType::uint64, "7"), "7");
    EXPECT_EQ(problemsOfConstant(ValueType::number, "7"), "7");
    EXPECT_EQ(problemsOfConstant(ValueType::number, "0.5"), "0.5");
    EXPECT_EQ(problemsOfConstant(ValueType::text, "\"a\""), "\"a\"");
    EXPECT_EQ(problemsOfConstant(ValueType::frame, "[1, 2, 3, 4, 5, 6]"), "(1, 2, 3, 4, 5, 6)");
    EXPECT_EQ(problemsOfConstant(ValueType::vector3, "[1, 2, 3]"), "(1, 2, 3)");
    EXPECT_EQ(problemsOfConstant(ValueType::numbers, "[1, 2]"), "[1, 2]");
    EXPECT_EQ(problemsOfConstant(ValueType::texts, "[\"a\", \"b\"]"), "[\"a\", \"b\"]");
    EXPECT_EQ(problemsOfConstant(ValueType::ranges, "[[0, 1], [2, 3]]"), "[0..1, 2..3]");
    EXPECT_EQ(problemsOfConstant(ValueType::frames, "[[1, 2, 3, 4, 5, 6]]"),
              "[(1, 2, 3, 4, 5, 6)]");
    for (const auto type :
         {ValueType::numbers, ValueType::texts, ValueType::ranges, ValueType::frames}) {
        EXPECT_EQ(problemsOfConstant(type, "[]"), "[]");
    }
}

TEST(Constant, ThatIsNoneOfItsTypeIsRefusedWithHowToWriteIt) {
    using skill::ValueType;
    struct Case {
        ValueType type;
        const char* constant;
        const char* how;
    };
    for (const auto& [type, constant, how] :
         {Case{ValueType::boolean, "1", "true or false"},
          Case{ValueType::int32, "2147483648", "a whole number"},
          Case{ValueType::uint32, "-1", "a whole number"},
          Case{ValueType::uint64, "-1", "a whole number"},
          Case{ValueType::int32, "0.5", "a whole number"},
          Case{ValueType::number, "true", "a number"}, Case{ValueType::text, "7", "a text"},
          Case{ValueType::text, "[]", "a text"},
          Case{ValueType::frame, "[1, 2, 3, 4, 5]", "a frame: [x, y, z, a, b, c] in m and rad"},
          Case{ValueType::vector3, "[1, 2]", "a vector: [x, y, z]"},
          Case{ValueType::numbers, "[[1, 2]]", "a list of numbers"},
          Case{ValueType::texts, "[1]", "a list of texts"},
          Case{ValueType::ranges, "[[1, 2], [3]]", "a list of ranges: [[low, high], ...]"},
          Case{ValueType::ranges, "[1, 2]", "a list of ranges: [[low, high], ...]"},
          Case{ValueType::frames, "[[1, 2]]",
               "a list of frames: [[x, y, z, a, b, c], ...] in m and rad"}}) {
        EXPECT_THAT(problemsOfConstant(type, constant),
                    HasSubstr("with.P: is not " + std::string(how)))
            << constant;
    }
}

}  // namespace
}  // namespace metier::composition
