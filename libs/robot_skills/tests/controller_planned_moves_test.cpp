#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "controller_planned_bench.hpp"
#include "metier/motion/frame.hpp"
#include "moves/controller_planned_motion.hpp"

namespace metier::robot_skills {
namespace {

using device::ControllerPlannedMotion;
using skill::Frame;
using skill::Reason;
using skill::State;
using skill::SubState;
using skill::Value;
using skill::ValueMap;
using ::testing::HasSubstr;

const ValueMap kUp{{"TargetPosition", Frame{0, 0, 0.1}}, {"Relative", std::int32_t{1}}};

ValueMap with(ValueMap values, const ValueMap& more) {
    values.insert(more.begin(), more.end());
    return values;
}

std::vector<double> turned(const Bench& bench, double by) {
    const auto joints = bench.commanded();
    std::vector<double> target(joints.begin(), joints.end());
    target[0] += by;
    return target;
}

class ControllerPlannedMove : public ::testing::Test {
protected:
    skill::Program& line() { return bench.program(kCartesianLinear); }
    bool startedUp() {
        const bool started = bench.start(kCartesianLinear, kUp).has_value();
        bench.steps(150);  // steps of 1 ms: near the middle
        return started && line().state() == State::running;
    }

    ControllerPlannedBench planned;
    Bench& bench = planned.bench;
    SimulatedPlanner& planner = planned.planner();
};

TEST_F(ControllerPlannedMove, ALineIsRunByTheControllerToItsPose) {
    const Eigen::Vector3d to = bench.commandedPose().translation + Eigen::Vector3d(0, 0, 0.1);
    ASSERT_TRUE(bench.start(kCartesianLinear, kUp));
    ASSERT_TRUE(bench.stepUntil(kCartesianLinear, State::ready));
    EXPECT_LE((bench.commandedPose().translation - to).norm(), 1e-6);
    ASSERT_EQ(planner.asked.size(), 1U);
    EXPECT_EQ(planner.asked[0].path, ControllerPlannedMotion::Path::line);
    EXPECT_NEAR(planner.asked[0].target_flange->z, to.z(), 1e-9);
    const auto result = line().finalResult();
    EXPECT_NEAR(std::get<Frame>(result.at("ReachedPose")).z, to.z(), 1e-6);
    EXPECT_GT(std::get<double>(result.at("Duration")), 0.1);
    EXPECT_LT(std::get<double>(result.at("LargestPathDeviation")), 1e-6);
}

TEST_F(ControllerPlannedMove, APtpToAPoseBecomesOneToTheJointsThatMetierChose) {
    ASSERT_TRUE(bench.start(kCartesianPtp, kUp));
    ASSERT_TRUE(bench.stepUntil(kCartesianPtp, State::ready));
    ASSERT_EQ(planner.asked.size(), 1U);
    EXPECT_EQ(planner.asked[0].path, ControllerPlannedMotion::Path::joint);
    EXPECT_FALSE(planner.asked[0].target_flange);
    EXPECT_LE(device::largestDifference(planner.asked[0].target_joints,
                                        bench.arm().state().commanded_position),
              1e-9);
}

TEST_F(ControllerPlannedMove, TheControllerMayBeAsFastAsThePlan) {
    ASSERT_TRUE(bench.start(kJointPtp, {{"TargetJointPosition", turned(bench, 0.5)}}));
    EXPECT_NEAR(planner.asked.back().velocity_share, 1.0, 1e-9);
    ASSERT_TRUE(bench.stepUntil(kJointPtp, State::ready));
    const double half = bench.model().limits(0).velocity / 2;
    ASSERT_TRUE(bench.start(kJointPtp, {{"TargetJointPosition", turned(bench, -0.5)},
                                        {"MaxVelocity", std::vector<double>(7, half)},
                                        {"SpeedOverride", 0.5}}));
    EXPECT_NEAR(planner.asked.back().velocity_share, 0.25, 1e-9);
    EXPECT_NEAR(planner.asked.back().acceleration_share, 1.0, 1e-9);
}

TEST_F(ControllerPlannedMove, ALinesSpeedIsThatOfTheRequestAndItsAccelerationTheRobotsOwn) {
    ASSERT_TRUE(
        bench.start(kCartesianLinear,
                    with(kUp, {{"MaxVelocity", std::vector<double>{.05, .05, .05, 1, 1, 1}}})));
    EXPECT_NEAR(planner.asked.back().line_velocity, 0.05, 1e-4);
    EXPECT_EQ(planner.asked.back().line_acceleration, bench.model().cartesianLimits().acceleration);
}

TEST_F(ControllerPlannedMove, WhatMetiersPlannerRefusesIsNotAskedOfTheController) {
    const auto refused = bench.start(
        kCartesianLinear, {{"TargetPosition", Frame{2, 0, 0}}, {"Relative", std::int32_t{1}}});
    EXPECT_EQ(refused.error().code, Errc::unreachable);
    EXPECT_TRUE(planner.asked.empty());
}

TEST_F(ControllerPlannedMove, AJointLineEndsAtItsJoints) {
    const auto up = bench.model().kinematics().inverse(
        {bench.commandedPose().translation + Eigen::Vector3d(0, 0, 0.1),
         bench.commandedPose().rotation},
        {bench.commanded(), {}, {}});
    ASSERT_TRUE(up);
    const std::vector<double> target(up->begin(), up->end());
    ASSERT_TRUE(bench.start(kJointLinear, {{"TargetJointPosition", target}}));
    ASSERT_TRUE(bench.stepUntil(kJointLinear, State::ready));
    EXPECT_EQ(planner.asked.back().path, ControllerPlannedMotion::Path::line);
}

TEST_F(ControllerPlannedMove, AMoveToJointsThatEndsElsewhereFails) {
    planner.behaviour.misses_by = 0.02;
    ASSERT_TRUE(bench.start(kJointPtp, {{"TargetJointPosition", turned(bench, 0.2)}}));
    ASSERT_TRUE(bench.stepUntil(kJointPtp, State::halted));
    EXPECT_THAT(bench.program(kJointPtp).reasonText(), HasSubstr("0.0200 rad"));
}

TEST_F(ControllerPlannedMove, IsSuspendedAtStandstillAndGoesOnToTheSameTarget) {
    const auto from = bench.commandedPose().translation;
    const Eigen::Vector3d to = from + Eigen::Vector3d(0, 0, 0.1);
    ASSERT_TRUE(startedUp());
    ASSERT_TRUE(line().suspend(bench.caller()));
    ASSERT_TRUE(bench.stepUntil(kCartesianLinear, State::suspended));
    EXPECT_TRUE(bench.arm().state().standstill);
    EXPECT_GT((bench.commandedPose().translation - to).norm(), 0.01);
    EXPECT_LE(distanceFromLine(bench.commandedPose().translation, from, to), 1e-6);
    ASSERT_TRUE(line().resume(bench.caller()));
    ASSERT_TRUE(bench.stepUntil(kCartesianLinear, State::ready));
    EXPECT_LE((bench.commandedPose().translation - to).norm(), 1e-6);
    EXPECT_EQ(planner.asked.size(), 2U);
}

TEST_F(ControllerPlannedMove, IsNotResumedWhenTheArmWasMoved) {
    ASSERT_TRUE(startedUp());
    ASSERT_TRUE(line().suspend(bench.caller()));
    ASSERT_TRUE(bench.stepUntil(kCartesianLinear, State::suspended));
    auto moved = bench.arm().state().position;
    moved[2] += 0.01;
    bench.arm().moveByHand(moved);
    bench.steps(100);
    EXPECT_THAT(line().resume(bench.caller()).error().message, HasSubstr("axis 3 by 0.0100 rad"));
    EXPECT_EQ(line().state(), State::suspended);
}

TEST_F(ControllerPlannedMove, IsHaltedAtStandstill) {
    ASSERT_TRUE(startedUp());
    ASSERT_TRUE(line().halt(bench.caller()));
    ASSERT_TRUE(bench.stepUntil(kCartesianLinear, State::halted));
    EXPECT_TRUE(bench.arm().state().standstill);
    EXPECT_EQ(line().subState(), SubState::halted_by_client);
    ASSERT_TRUE(line().reset(bench.caller()));
    EXPECT_TRUE(bench.start(kJointPtp, {{"TargetJointPosition", turned(bench, 0.1)}}));
}

TEST_F(ControllerPlannedMove, CanBeGivenUpWhileSuspended) {
    ASSERT_TRUE(startedUp());
    ASSERT_TRUE(line().suspend(bench.caller()));
    ASSERT_TRUE(bench.stepUntil(kCartesianLinear, State::suspended));
    ASSERT_TRUE(line().halt(bench.caller()));
    bench.step();
    EXPECT_EQ(line().state(), State::halted);
}

TEST_F(ControllerPlannedMove, IsHaltedWithTheControllersReason) {
    ASSERT_TRUE(startedUp());
    bench.arm().protectiveStop("fence opened");
    ASSERT_TRUE(bench.stepUntil(kCartesianLinear, State::halted));
    EXPECT_EQ(line().reason(), Reason::error);
    EXPECT_THAT(line().reasonText(), HasSubstr("fence opened"));
}

TEST_F(ControllerPlannedMove, IsHaltedBySafetyWhileSuspended) {
    ASSERT_TRUE(startedUp());
    ASSERT_TRUE(line().suspend(bench.caller()));
    ASSERT_TRUE(bench.stepUntil(kCartesianLinear, State::suspended));
    bench.arm().protectiveStop("fence opened");
    bench.steps(5);
    EXPECT_EQ(line().state(), State::halted);
}

TEST_F(ControllerPlannedMove, IsLostWithItsController) {
    ASSERT_TRUE(startedUp());
    bench.arm().disconnect();
    ASSERT_TRUE(bench.stepUntil(kCartesianLinear, State::halted));
    EXPECT_EQ(line().subState(), SubState::halted_device_lost);
}

TEST_F(ControllerPlannedMove, AControllerThatRefusesHaltsTheSkillWithItsText) {
    planner.behaviour.refuses = Error{Errc::device_fault, "iiwa7: not ready to move"};
    ASSERT_TRUE(bench.start(kCartesianLinear, kUp));
    bench.step();
    EXPECT_EQ(line().state(), State::halted);
    EXPECT_EQ(line().reasonText(), "iiwa7: not ready to move");
}

TEST_F(ControllerPlannedMove, WhatSomebodyElseStopsIsAnError) {
    planner.behaviour.stops_by_itself = true;
    ASSERT_TRUE(bench.start(kCartesianLinear, kUp));
    ASSERT_TRUE(bench.stepUntil(kCartesianLinear, State::halted));
    EXPECT_THAT(line().reasonText(), HasSubstr("stopped from outside"));
}

TEST_F(ControllerPlannedMove, StopsWhenItsProgramIsGone) {
    ASSERT_TRUE(startedUp());
    bench.destroyProgram(kCartesianLinear);
    EXPECT_TRUE(bench.stepUntil([&] { return bench.arm().state().standstill; }));
    EXPECT_GT(std::abs(bench.commandedPose().translation.z() - planner.asked[0].target_flange->z),
              1e-3);
}

/// A UR5 with a tool that sticks out by 15 cm.
motion::RobotModel withTool() {
    auto chain = modelOf("ur5").chain();
    motion::ToolFrame tool;
    tool.name = "pen";
    tool.flange_from_tool.translation = {0.0, 0.0, 0.15};
    chain.tools.push_back(tool);
    return motion::RobotModel::fromChain(std::move(chain)).value();
}

Result<ControllerPlannedMotion> askedFor(const motion::RobotModel& model, const Frame& relative) {
    motion::LinRequest request;
    request.start = model.home();
    request.target = motion::toPose(relative);
    request.reference = motion::TargetReference::relative_tool;
    request.tool_frame = "pen";
    return controllerPlannedMotion({model, motion::Planner(model).lin(request).value(),
                                    PathDeviationMeter::Path::cartesian_line, MoveParameters{}});
}

TEST(PlannedMoveOfATool, IsALineOfTheFlangeWhileTheOrientationStays) {
    const auto model = withTool();
    const auto motion = askedFor(model, Frame{0, 0, 0.05});
    ASSERT_TRUE(motion) << motion.error().message;
    const auto start = model.kinematics().forward(model.home());
    const auto end = motion::toPose(*motion->target_flange);
    EXPECT_NEAR(motion::distanceBetween(start, end), 0.05, 1e-9);
}

TEST(PlannedMoveOfATool, IsNotTheControllersWhereTheFlangesLineIsNotTheTools) {
    const auto refused = askedFor(withTool(), Frame{0, 0, 0.05, 0, 0.4, 0});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::not_supported);
    EXPECT_THAT(refused.error().message, HasSubstr("off its line, limit 0.0001 m"));
}

}  // namespace
}  // namespace metier::robot_skills
