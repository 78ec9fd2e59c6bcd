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

}  // namespace
}  // namespace metier::composition
