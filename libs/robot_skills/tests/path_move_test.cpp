#include <gmock/gmock.h>

#include "bench.hpp"
#include "controller_planned_bench.hpp"
#include "metier/base/testing/allocation_count.hpp"
#include "metier/robot_skills/move_parameters.hpp"

namespace metier::robot_skills {
namespace {

using skill::Frame;
using skill::State;
using skill::ValueMap;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::string kPath = "CartesianPathMoveSkill";

/// A "U" along the base axes: to the side, up, and back.
ValueMap upsideDown(double radius) {
    return {{"Poses", std::vector<Frame>{{0, 0.1, 0}, {0, 0, 0.1}, {0, -0.1, 0}}},
            {"BlendRadii", std::vector<double>{radius, radius, 0.0}},
            {"Relative", std::int32_t{1}}};
}

std::string refusalOf(Bench& bench, const ValueMap& values) {
    const auto started = bench.start(kPath, values);
    EXPECT_EQ(bench.program(kPath).state(), State::ready);
    return started ? "started" : started.error().message;
}

double number(const skill::Program& program, const std::string& result) {
    return std::get<double>(program.finalResult().at(result));
}

TEST(CartesianPathMove, PassesItsCornersWithoutAStopAndEndsAtTheLastPose) {
    Bench bench;
    const Eigen::Vector3d from = bench.commandedPose().translation;
    const Eigen::Vector3d corner = from + Eigen::Vector3d(0, 0.1, 0);
    States states;
    bench.program(kPath).attach(states);
    ASSERT_TRUE(bench.start(kPath, upsideDown(0.03)));
    double to_corner = 1;
    double slowest_in_corner = 1;
    Eigen::Vector3d last = from;
    ASSERT_TRUE(bench.stepUntil([&] {
        const Eigen::Vector3d now = bench.commandedPose().translation;
        to_corner = std::min(to_corner, (now - corner).norm());
        if ((now - corner).norm() < 0.02) {
            slowest_in_corner = std::min(slowest_in_corner, (now - last).norm() / 0.008);
        }
        last = now;
        return bench.program(kPath).state() == State::ready;
    }));
    EXPECT_THAT(states.seen, ElementsAre(State::running, State::ready));
    EXPECT_GT(to_corner, 0.001);
    EXPECT_LT(to_corner, 0.03);
    EXPECT_GT(slowest_in_corner, 0.02) << "[m/s]";
    EXPECT_LT((last - from - Eigen::Vector3d(0, 0, 0.1)).norm(), 1e-6);
    EXPECT_LT(number(bench.program(kPath), "LargestPathDeviation"), 1e-6) << "from the path itself";
    bench.program(kPath).detach(states);
}

TEST(CartesianPathMove, KeepsTheSpeedOfEachLine) {
    Bench bench;
    const double corner = bench.commandedPose().translation.y() + 0.1;
    auto values = upsideDown(0.01);
    values["Speeds"] = std::vector<double>{0.1, 0.04, 0.0};
    ASSERT_TRUE(bench.start(kPath, values));
    auto last = bench.commandedPose().translation;
    double fastest_on_second = 0;
    double fastest = 0;
    ASSERT_TRUE(bench.stepUntil([&] {
        const auto now = bench.commandedPose().translation;
        const double speed = (now - last).norm() / 0.008;
        fastest = std::max(fastest, speed);
        if (std::abs(now.y() - corner) < 1e-9 && std::abs(last.y() - corner) < 1e-9) {
            fastest_on_second = std::max(fastest_on_second, speed);
        }
        last = now;
        return bench.program(kPath).state() == State::ready;
    }));
    EXPECT_NEAR(fastest_on_second, 0.04, 0.002);
    EXPECT_GT(fastest, 0.06);
}

TEST(CartesianPathMove, GoesOnAlongItsPathAfterSuspendInACorner) {
    Bench bench;
    const Eigen::Vector3d from = bench.commandedPose().translation;
    const Eigen::Vector3d corner = from + Eigen::Vector3d(0, 0.1, 0);
    ASSERT_TRUE(bench.start(kPath, upsideDown(0.04)));
    ASSERT_TRUE(bench.stepUntil(
        [&] { return (bench.commandedPose().translation - corner).norm() < 0.025; }));
    ASSERT_TRUE(bench.program(kPath).suspend(bench.caller()));
    ASSERT_TRUE(bench.stepUntil(kPath, State::suspended));
    ASSERT_TRUE(bench.program(kPath).resume(bench.caller()));
    ASSERT_TRUE(bench.stepUntil(kPath, State::ready));
    EXPECT_LT(number(bench.program(kPath), "LargestPathDeviation"), 1e-6);
}

TEST(CartesianPathMove, HaltsOnItsPath) {
    Bench bench;
    ASSERT_TRUE(bench.start(kPath, upsideDown(0.03)));
    bench.steps(40);
    ASSERT_TRUE(bench.program(kPath).halt(bench.caller()));
    ASSERT_TRUE(bench.stepUntil(kPath, State::halted));
    EXPECT_EQ(bench.program(kPath).reason(), skill::Reason::by_client);
}

TEST(CartesianPathMove, TellsWhichPoseIsOutOfReachAndWhy) {
    Bench bench;
    auto values = upsideDown(0.03);
    std::get<std::vector<Frame>>(values["Poses"])[1].z = 2.0;
    EXPECT_THAT(refusalOf(bench, values), HasSubstr("waypoint 2: unreachable: "));
}

TEST(CartesianPathMove, RefusesRadiiThatDoNotFit) {
    Bench bench;
    EXPECT_THAT(refusalOf(bench, upsideDown(0.06)),
                HasSubstr("waypoint 1: blend radius 0.06 m over 0.0500 m"));
    EXPECT_THAT(refusalOf(bench, upsideDown(0.0)), HasSubstr("waypoint 1: blend radius 0 m"));
    auto values = upsideDown(0.03);
    values["BlendRadii"] = std::vector<double>{0.03};
    EXPECT_THAT(refusalOf(bench, values), HasSubstr("BlendRadii: 1 values for 3 poses"));
    values = upsideDown(0.03);
    values["Speeds"] = std::vector<double>{0.1, 0.1};
    EXPECT_THAT(refusalOf(bench, values), HasSubstr("Speeds: 2 values for 3 poses"));
}

TEST(CartesianPathMove, RefusesNoPoseAndTooManyWhenTheyAreWritten) {
    Bench bench;
    EXPECT_FALSE(bench.write(kPath, {{"Poses", std::vector<Frame>()}}));
    EXPECT_FALSE(bench.write(kPath, {{"Poses", std::vector<Frame>(kMostPoses + 1)}}));
    EXPECT_FALSE(bench.write(kPath, {{"Speeds", std::vector<double>{11.0}}}));
}

TEST(CartesianPathMove, ShowsInCheckHowItWouldBe) {
    Bench bench;
    auto report = bench.program(kPath).check(bench.caller(), upsideDown(0.03));
    EXPECT_TRUE(report.possible) << report.reason;
    EXPECT_GT(report.planned_duration, 0.5);
    EXPECT_EQ(report.joint_path.size(), 50U);
    report = bench.program(kPath).check(bench.caller(), upsideDown(0.06));
    EXPECT_FALSE(report.possible);
    EXPECT_THAT(report.reason, HasSubstr("blend radius"));
}

TEST(CartesianPathMove, OfOnePoseNeedsNoRadius) {
    Bench bench("iiwa7");
    ASSERT_TRUE(bench.start(
        kPath, {{"Poses", std::vector<Frame>{{0, 0, -0.1}}}, {"Relative", std::int32_t{1}}}));
    ASSERT_TRUE(bench.stepUntil(kPath, State::ready));
}

TEST(CartesianPathMove, DoesNotAllocateInTheCycle) {
    Bench bench;
    ASSERT_TRUE(bench.start(kPath, upsideDown(0.03)));
    const auto before = allocationCount();
    for (int i = 0; i < 100; ++i) {
        bench.arm().cycle(SteadyTime(bench.arm().info().cycle * i), 0);
    }
    EXPECT_EQ(allocationCount(), before);
}

TEST(CartesianPathMove, RunsBySetPointsWhereTheControllerPlansTheOtherMoves) {
    ControllerPlannedBench planned;
    ASSERT_TRUE(planned.bench.start(
        kPath, {{"Poses", std::vector<Frame>{{0, 0, -0.1}}}, {"Relative", std::int32_t{1}}}));
    ASSERT_TRUE(planned.bench.stepUntil(kPath, State::ready));
}

}  // namespace
}  // namespace metier::robot_skills
