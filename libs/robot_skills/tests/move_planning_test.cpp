#include "metier/robot_skills/move_planning.hpp"

#include <gmock/gmock.h>

#include <random>

#include "bench.hpp"
#include "metier/motion/frame.hpp"

namespace metier::robot_skills {
namespace {

using motion::JointVector;
using motion::RefusalReason;
using skill::ValueMap;

/// A pose near the middle of what a UR5 can reach; some are too far, some too near the base.
skill::Frame randomPose(std::mt19937& random) {
    std::uniform_real_distribution<double> along(-0.9, 0.9);
    std::uniform_real_distribution<double> angle(-3.0, 3.0);
    return {along(random), along(random), along(random), angle(random), 0.3, angle(random)};
}

std::string textOf(const motion::Planned<motion::Trajectory>& plan) {
    return plan ? "started" : plan.error().error.message;
}

std::string textOf(const Result<void>& started) {
    return started ? "started" : started.error().message;
}

TEST(MovePlanning, AnswersAsStartDoes) {
    std::mt19937 random(7);
    int refused = 0;
    for (int i = 0; i < 20; ++i) {
        Bench bench;
        const auto pose = randomPose(random);
        const ValueMap values{{"TargetPosition", pose}};
        CartesianMoveParameters parameters;
        parameters.target_position = pose;
        const bool linear = i % 2 == 0;
        const auto plan = (linear ? planCartesianLinear : planCartesianPtp)(
            bench.model(), bench.commanded(), parameters);
        const auto start = bench.start(linear ? kCartesianLinear : kCartesianPtp, values);
        EXPECT_EQ(textOf(plan), textOf(start)) << "target " << i;
        refused += plan ? 0 : 1;
    }
    EXPECT_THAT(refused, ::testing::AllOf(::testing::Gt(3), ::testing::Lt(17)));
}

TEST(MovePlanning, TellsReasonAxisAndPlaceOfARefusal) {
    const auto model = modelOf("edo");
    JointMoveParameters parameters;
    parameters.target_joint_position = {0, 0, 0, 0, 0, 3.2};
    const auto plan = planJointPtp(model, model.home(), parameters);
    ASSERT_FALSE(plan);
    EXPECT_EQ(plan.error().reason, RefusalReason::joint_limit);
    EXPECT_EQ(plan.error().axis, 5U);
}

TEST(MovePlanning, EndsAPtpWhereTheNextLineCanBegin) {
    const auto model = modelOf("ur5");
    CartesianMoveParameters parameters;
    parameters.target_position = motion::toFrame(model.kinematics().forward(model.home()));
    parameters.next_position = parameters.target_position;
    parameters.next_position->z += 0.1;
    EXPECT_TRUE(planCartesianPtp(model, model.home(), parameters));
    parameters.next_position->z += 10;
    const auto plan = planCartesianPtp(model, model.home(), parameters);
    ASSERT_FALSE(plan);
    EXPECT_THAT(plan.error().error.message, ::testing::HasSubstr("the next line is possible from"));
}

TEST(MovePlanning, AddsARelativeJointTargetToTheStart) {
    const auto model = modelOf("iiwa7");
    JointMoveParameters parameters;
    parameters.target_joint_position = {0, 0, 0, 0, 0, 0, 0.25};
    parameters.relative = static_cast<std::int32_t>(Relative::base);
    const auto plan = planJointPtp(model, model.home(), parameters);
    ASSERT_TRUE(plan);
    auto expected = model.home();
    expected[6] += 0.25;
    EXPECT_LT(maxDifference(plan->end(), expected), 1e-12);
}

}  // namespace
}  // namespace metier::robot_skills
