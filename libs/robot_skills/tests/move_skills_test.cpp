#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bench.hpp"
#include "metier/motion/frame.hpp"
#include "metier/motion/rotation.hpp"
#include "metier/robot_skills/move_parameters.hpp"

namespace metier::robot_skills {
namespace {

using skill::Frame;
using skill::State;
using skill::Value;
using skill::ValueMap;
using ::testing::ElementsAre;

Value relative(Relative mode) {
    return static_cast<std::int32_t>(mode);
}

/// 10 cm straight up, as the square's sides are.
const ValueMap kUp{{"TargetPosition", Frame{0, 0, 0.1, 0, 0, 0}},
                   {"Relative", relative(Relative::base)}};

std::vector<double> shifted(const motion::JointVector& from, double by) {
    std::vector<double> joints(from.begin(), from.end());
    for (auto& joint : joints) {
        joint += by;
    }
    return joints;
}

double number(const skill::Program& program, const std::string& result) {
    return std::get<double>(program.finalResult().at(result));
}

TEST(CartesianLinearMove, ReachesItsPoseAlongTheLine) {
    Bench bench;
    const auto from = bench.commandedPose().translation;
    const Eigen::Vector3d to = from + Eigen::Vector3d(0, 0, 0.1);
    States states;
    bench.program(kCartesianLinear).attach(states);
    ASSERT_TRUE(bench.start(kCartesianLinear, kUp));
    double off_line = 0;
    ASSERT_TRUE(bench.stepUntil([&] {
        off_line =
            std::max(off_line, distanceFromLine(bench.commandedPose().translation, from, to));
        return bench.program(kCartesianLinear).state() == State::ready;
    }));
    EXPECT_THAT(states.seen, ElementsAre(State::running, State::ready));
    EXPECT_LE(off_line, 1e-9) << "1e-6 mm";
    EXPECT_LE((bench.commandedPose().translation - to).norm(), 1e-9);
    bench.program(kCartesianLinear).detach(states);
}

TEST(CartesianLinearMove, TellsWhatItReached) {
    Bench bench;
    const auto from = bench.commandedPose().translation;
    ASSERT_TRUE(bench.start(kCartesianLinear, kUp));
    ASSERT_TRUE(bench.stepUntil(kCartesianLinear, State::ready));
    const auto& program = bench.program(kCartesianLinear);
    const auto pose = std::get<Frame>(program.finalResult().at("ReachedPose"));
    EXPECT_NEAR(pose.z, from.z() + 0.1, 1e-6);
    EXPECT_NEAR(pose.x, from.x(), 1e-6);
    const auto joints =
        std::get<std::vector<double>>(program.finalResult().at("ReachedJointPosition"));
    EXPECT_NEAR(joints[1], bench.arm().state().position[1], 1e-6);
    EXPECT_GT(number(program, "Duration"), 0.1);
    EXPECT_LT(number(program, "Duration"), 2.0);
    EXPECT_LT(number(program, "LargestPathDeviation"), 1e-9) << "dead time keeps the path";
}

TEST(CartesianLinearMove, KeepsTheVelocityItIsGiven) {
    Bench bench;
    auto values = kUp;
    values["MaxVelocity"] = std::vector<double>{0.05, 0.05, 0.05, 1, 1, 1};
    ASSERT_TRUE(bench.start(kCartesianLinear, values));
    auto last = bench.commandedPose().translation;
    double fastest = 0;
    ASSERT_TRUE(bench.stepUntil([&] {
        const auto now = bench.commandedPose().translation;
        fastest = std::max(fastest, (now - last).norm() / 0.008);
        last = now;
        return bench.program(kCartesianLinear).state() == State::ready;
    }));
    EXPECT_LE(fastest, 0.05 * 1.001);
    EXPECT_GE(fastest, 0.05 * 0.99);
}

TEST(CartesianLinearMove, IsSlowerWithASpeedOverride) {
    Bench bench;
    auto slow = kUp;
    slow["MaxVelocity"] = std::vector<double>{0.05, 0.05, 0.05, 1, 1, 1};
    slow["SpeedOverride"] = 0.5;
    ASSERT_TRUE(bench.start(kCartesianLinear, slow));
    ASSERT_TRUE(bench.stepUntil(kCartesianLinear, State::ready));
    EXPECT_GT(number(bench.program(kCartesianLinear), "Duration"), 4.0);
}

TEST(CartesianLinearMove, ComesBackToItsStartAfterASquare) {
    Bench bench;
    const auto start = bench.commandedPose().translation;
    for (const auto& side :
         {Frame{0, 0.1, 0}, Frame{0, 0, 0.1}, Frame{0, -0.1, 0}, Frame{0, 0, -0.1}}) {
        ASSERT_TRUE(bench.start(
            kCartesianLinear, {{"TargetPosition", side}, {"Relative", relative(Relative::base)}}));
        ASSERT_TRUE(bench.stepUntil(kCartesianLinear, State::ready));
    }
    EXPECT_LE((bench.commandedPose().translation - start).norm(), 1e-9);
}

TEST(CartesianLinearMove, MovesAlongTheToolAxes) {
    Bench bench;
    const auto start = bench.commandedPose();
    ASSERT_TRUE(bench.start(kCartesianLinear, {{"TargetPosition", Frame{0, 0, -0.05}},
                                               {"Relative", relative(Relative::tool)}}));
    ASSERT_TRUE(bench.stepUntil(kCartesianLinear, State::ready));
    const Eigen::Vector3d expected = start * Eigen::Vector3d(0, 0, -0.05);
    EXPECT_LE((bench.commandedPose().translation - expected).norm(), 1e-9);
}

TEST(CartesianPtpMove, ReachesAnAbsolutePose) {
    Bench bench;
    const auto pose = bench.commandedPose();
    const auto frame = motion::toFrame(pose);
    const Frame target{frame.x + 0.1, frame.y - 0.2, frame.z, frame.a, frame.b, frame.c};
    ASSERT_TRUE(bench.start(kCartesianPtp, {{"TargetPosition", target}}));
    ASSERT_TRUE(bench.stepUntil(kCartesianPtp, State::ready));
    const auto reached = bench.commandedPose();
    EXPECT_NEAR(reached.translation.x(), target.x, 1e-9);
    EXPECT_NEAR(reached.translation.y(), target.y, 1e-9);
    EXPECT_LE(motion::rotationAngleBetween(reached.rotation, pose.rotation), 1e-9);
    EXPECT_LT(number(bench.program(kCartesianPtp), "LargestPathDeviation"), 1e-9);
}

TEST(CartesianPtpMove, OfASixAxisArmIgnoresTheRedundancyAngle) {
    Bench bench;
    const auto from = bench.commandedPose().translation;
    ASSERT_TRUE(bench.start(kCartesianPtp, {{"TargetPosition", Frame{0, 0, 0.05}},
                                            {"Relative", std::int32_t{1}},
                                            {"RedundancyAngle", 0.5}}));
    ASSERT_TRUE(bench.stepUntil(kCartesianPtp, State::ready));
    EXPECT_NEAR(bench.commandedPose().translation.z(), from.z() + 0.05, 1e-9);
}

TEST(JointPtpMove, ReachesItsJointsTogetherOnOneLine) {
    Bench bench;
    const auto from = bench.commanded();
    const auto to = motion::JointVector::from(shifted(from, 0.3)).value();
    ASSERT_TRUE(bench.start(kJointPtp, {{"TargetJointPosition", shifted(from, 0.3)}}));
    ASSERT_TRUE(bench.stepUntil([&] {
        const auto now = bench.commanded();
        const double share = now[0] - from[0];
        for (const double joint : {now[1] - from[1], now[5] - from[5]}) {
            EXPECT_NEAR(joint, share, 1e-9);
        }
        return bench.program(kJointPtp).state() == State::ready;
    }));
    EXPECT_LE(motion::maxDifference(bench.commanded(), to), 1e-9);
}

TEST(JointPtpMove, AddsToTheJointPositionWhenRelative) {
    Bench bench;
    const auto from = bench.commanded();
    ASSERT_TRUE(bench.start(kJointPtp, {{"TargetJointPosition", std::vector<double>(6, 0.1)},
                                        {"Relative", relative(Relative::base)}}));
    ASSERT_TRUE(bench.stepUntil(kJointPtp, State::ready));
    EXPECT_NEAR(bench.commanded()[3], from[3] + 0.1, 1e-9);
}

TEST(JointLinearMove, RunsStraightToWhereTheJointsPutTheTool) {
    Bench bench;
    auto target = shifted(bench.commanded(), 0.0);
    target[0] += 0.2;
    const auto from = bench.commandedPose().translation;
    const auto to =
        bench.model().kinematics().forward(motion::JointVector::from(target).value()).translation;
    ASSERT_TRUE(bench.start(kJointLinear, {{"TargetJointPosition", target}}));
    double off_line = 0;
    ASSERT_TRUE(bench.stepUntil([&] {
        off_line =
            std::max(off_line, distanceFromLine(bench.commandedPose().translation, from, to));
        return bench.program(kJointLinear).state() == State::ready;
    }));
    EXPECT_LE(off_line, 1e-9);
    EXPECT_NEAR(bench.commanded()[0], target[0], 1e-6);
}

class EveryRobot : public ::testing::TestWithParam<const char*> {};

TEST_P(EveryRobot, RunsLinesWithTheSixZerosOfPublishedClients) {
    Bench bench(GetParam());
    auto values = kUp;
    values["TargetPosition"] = Frame{0, 0, -0.05};
    values["MaxVelocity"] = std::vector<double>(6, 0.0);
    values["MaxAcceleration"] = std::vector<double>(6, 0.0);
    values["AxisBounds"] = std::vector<skill::Range>(6);
    ASSERT_TRUE(bench.start(kCartesianLinear, values));
    ASSERT_TRUE(bench.stepUntil(kCartesianLinear, State::ready))
        << bench.program(kCartesianLinear).reasonText();
}

TEST_P(EveryRobot, RunsPtpWithTheSixZerosOfPublishedClients) {
    Bench bench(GetParam());
    ValueMap values{{"TargetPosition", Frame{0, 0.05, -0.05}},
                    {"Relative", relative(Relative::base)},
                    {"MaxVelocity", std::vector<double>(6, 0.0)},
                    {"MaxAcceleration", std::vector<double>(6, 0.0)},
                    {"AxisBounds", std::vector<skill::Range>(6)}};
    const auto started = bench.start(kCartesianPtp, values);
    ASSERT_TRUE(started) << started.error().message;
    ASSERT_TRUE(bench.stepUntil(kCartesianPtp, State::ready))
        << bench.program(kCartesianPtp).reasonText();
}

INSTANTIATE_TEST_SUITE_P(All, EveryRobot,
                         ::testing::Values("ur5", "ur5e", "iiwa7", "iiwa14", "edo"),
                         [](const auto& test) { return std::string(test.param); });

TEST(MoveSkills, FinishAZeroMove) {
    Bench bench;
    ASSERT_TRUE(bench.start(kCartesianLinear,
                            {{"TargetPosition", Frame{}}, {"Relative", relative(Relative::base)}}));
    ASSERT_TRUE(bench.stepUntil(kCartesianLinear, State::ready));
    EXPECT_EQ(number(bench.program(kCartesianLinear), "LargestPathDeviation"), 0.0);
}

TEST(MoveSkills, ExcludeEachOther) {
    Bench bench;
    ASSERT_TRUE(bench.start(kCartesianLinear, kUp));
    const auto second = bench.start(kCartesianPtp, kUp);
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().code, Errc::resource_unavailable);
    EXPECT_EQ(bench.start(kPositionStream, {}).error().code, Errc::resource_unavailable);
    ASSERT_TRUE(bench.stepUntil(kCartesianLinear, State::ready));
    EXPECT_TRUE(bench.program(kCartesianPtp).start(bench.caller()));
}

TEST(MoveSkills, MeasureADeviationThatTheArmsLagMakes) {
    Bench bench("ur5", [](auto& options) { options.time_constant = 0.05; });
    auto target = shifted(bench.commanded(), 0.0);
    target[0] += 0.8;
    ASSERT_TRUE(bench.start(kJointLinear, {{"TargetJointPosition", target}}));
    ASSERT_TRUE(bench.stepUntil(kJointLinear, State::ready));
    EXPECT_GT(number(bench.program(kJointLinear), "LargestPathDeviation"), 1e-5);
    EXPECT_LT(number(bench.program(kJointLinear), "LargestPathDeviation"), 1e-2);
}

}  // namespace
}  // namespace metier::robot_skills
