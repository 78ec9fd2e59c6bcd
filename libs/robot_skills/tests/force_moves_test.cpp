#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "controller_planned_bench.hpp"
#include "given_sensor.hpp"
#include "metier/base/testing/allocation_count.hpp"

namespace metier::robot_skills {
namespace {

using device::SafetyState;
using skill::Frame;
using skill::Reason;
using skill::State;
using skill::SubState;
using skill::ValueMap;
using skill::Vector3;
using ::testing::HasSubstr;

ValueMap downUntil(double force, const ValueMap& more = {}) {
    ValueMap values{{"TargetPosition", Frame{0, 0, -0.1}},
                    {"Relative", std::int32_t{1}},
                    {"MaxForce", Vector3{0, 0, force}}};
    values.insert(more.begin(), more.end());
    return values;
}

Vector3 vector(const skill::Program& program, const std::string& result) {
    return std::get<Vector3>(program.finalResult().at(result));
}

// ---- by the controller's own condition ----------------------------------------------------------

class ControllerPlannedForceMove : public ::testing::Test {
protected:
    ControllerPlannedBench planned;
    Bench& bench = planned.bench;
    SimulatedPlanner& planner = planned.planner();
    skill::Program& force = bench.program(kForceMove);
};

TEST_F(ControllerPlannedForceMove, EndsAtItsTargetWithoutAContact) {
    ASSERT_TRUE(bench.start(kForceMove, downUntil(20)));
    ASSERT_TRUE(bench.stepUntil(kForceMove, State::ready));
    EXPECT_EQ(vector(force, "ForcesExceeded"), Vector3{});
    ASSERT_TRUE(planner.asked[0].until);
}

TEST_F(ControllerPlannedForceMove, WatchesTheFlangesAxisThatIsTheBaseFrames) {
    ASSERT_TRUE(bench.start(kForceMove, downUntil(20)));
    const auto& limits = planner.asked[0].until->force;
    EXPECT_FALSE(limits[0] || limits[1]);
    EXPECT_EQ(limits[2], 20.0) << "the tool points down";
}

TEST_F(ControllerPlannedForceMove, EndsAtAContactWithItsForceInTheBaseFrame) {
    const double from = bench.commandedPose().translation.z();
    planner.behaviour.contact_at = 0.4;
    planner.behaviour.force = {1.0, 0.0, -25.0};
    ASSERT_TRUE(bench.start(kForceMove, downUntil(20)));
    ASSERT_TRUE(bench.stepUntil(kForceMove, State::ready));
    EXPECT_NEAR(vector(force, "ContactForce").z, 25.0, 0.01) << "the flange looks down";
    EXPECT_NEAR(vector(force, "ForcesExceeded").z, 25.0, 0.01);
    EXPECT_NEAR(vector(force, "ForcesMax").z, 25.0, 0.01);
    const auto reached = std::get<Frame>(force.finalResult().at("ReachedPose"));
    EXPECT_LT(reached.z, from - 0.03);
    EXPECT_GT(reached.z, from - 0.09);
}

TEST_F(ControllerPlannedForceMove, IsHaltedByTheForceWhereThatIsAnError) {
    planner.behaviour.contact_at = 0.4;
    planner.behaviour.force = {0.0, 0.0, -25.0};
    ASSERT_TRUE(bench.start(kForceMove, downUntil(20, {{"HaltOnForce", true}})));
    ASSERT_TRUE(bench.stepUntil(kForceMove, State::halted));
    EXPECT_EQ(force.reason(), Reason::force_exceeded);
    EXPECT_EQ(force.subState(), SubState::halted_force);
    EXPECT_THAT(force.reasonText(), HasSubstr("25.0"));
    EXPECT_THAT(force.reasonText(), HasSubstr("limit [0.0, 0.0, 20.0] N"));
}

TEST_F(ControllerPlannedForceMove, WithoutASensorIsRefusedWhereNoAxisOfTheFlangeIsTheBaseFrames) {
    ASSERT_TRUE(bench.start(kCartesianLinear, {{"TargetPosition", Frame{0, 0, 0, 0, 0.3, 0}},
                                               {"Relative", std::int32_t{1}}}));
    ASSERT_TRUE(bench.stepUntil(kCartesianLinear, State::ready));
    const auto refused = bench.start(kForceMove, downUntil(20));
    EXPECT_EQ(refused.error().code, Errc::not_supported);
    EXPECT_THAT(refused.error().message, HasSubstr("17.2 deg"));
}

TEST_F(ControllerPlannedForceMove, NeedsALimit) {
    EXPECT_THAT(bench.write(kForceMove, {{"MaxForce", Vector3{}}}).error().message,
                HasSubstr("MaxForce"));
    EXPECT_FALSE(bench.write(kForceMove, {{"MaxForce", Vector3{0, 0, -1}}}));
    EXPECT_FALSE(bench.start(kForceMove, {{"TargetPosition", Frame{0.5, 0, 0.5}}}));
}

// ---- by a sensor --------------------------------------------------------------------------------

class ForceMove : public ::testing::Test {
protected:
    GivenSensor sensor;
    Bench bench{"ur5", {}, [this](auto& arm, const auto& /*model*/) {
                    return ArmDevices{arm, nullptr, &sensor};
                }};
    skill::Program& force = bench.program(kForceMove);

    /// A force along z of the base frame, whichever way the flange is turned.
    void press(double newton) {
        const Eigen::Vector3d inFlange =
            bench.commandedPose().rotation.inverse() * Eigen::Vector3d(0, 0, newton);
        sensor.now.force = {inFlange.x(), inFlange.y(), inFlange.z()};
    }
    /// A wall so far below the start, as stiff as 5 N/mm.
    bool stepAgainstWall(double depth, State until) {
        const double wall = bench.commandedPose().translation.z() - depth;
        return bench.stepUntil([&] {
            press(std::max(0.0, 5000.0 * (wall - bench.commandedPose().translation.z())));
            return force.state() == until;
        });
    }
};

const ValueMap kSlowly{{"MaxVelocity", std::vector<double>{.05, .05, .05, 1, 1, 1}}};

TEST_F(ForceMove, EndsAtItsTargetWithoutAContact) {
    ASSERT_TRUE(bench.start(kForceMove, downUntil(20)));
    ASSERT_TRUE(bench.stepUntil(kForceMove, State::ready));
    EXPECT_EQ(vector(force, "ForcesExceeded"), Vector3{});
    EXPECT_GT(std::get<double>(force.finalResult().at("Duration")), 0.1);
}

TEST_F(ForceMove, BrakesOnItsPathAtAWall) {
    const auto from = bench.commandedPose().translation;
    ASSERT_TRUE(bench.start(kForceMove, downUntil(20, kSlowly)));
    ASSERT_TRUE(stepAgainstWall(0.05, State::ready));
    const auto at = bench.commandedPose().translation;
    EXPECT_GT(from.z() - at.z(), 0.054) << "20 N at 5 N/mm";
    EXPECT_LT(from.z() - at.z(), 0.057) << "and not much deeper";
    EXPECT_LE(distanceFromLine(at, from, from + Eigen::Vector3d(0, 0, -0.1)), 1e-9);
    EXPECT_GT(vector(force, "ForcesExceeded").z, 20.0);
    EXPECT_GE(vector(force, "ForcesMax").z, vector(force, "ForcesExceeded").z);
}

TEST_F(ForceMove, IsHaltedByTheForceWhereThatIsAnError) {
    auto values = downUntil(20, kSlowly);
    values["HaltOnForce"] = true;
    ASSERT_TRUE(bench.start(kForceMove, values));
    ASSERT_TRUE(stepAgainstWall(0.05, State::halted));
    EXPECT_EQ(force.subState(), SubState::halted_force);
    ASSERT_TRUE(force.reset(bench.caller()));
    EXPECT_TRUE(bench.start(kCartesianLinear,
                            {{"TargetPosition", Frame{0, 0, 0.1}}, {"Relative", std::int32_t{1}}}))
        << "the way out needs no force";
}

TEST_F(ForceMove, DoesNotTripBelowItsLimit) {
    press(19.0);
    ASSERT_TRUE(bench.start(kForceMove, downUntil(20)));
    ASSERT_TRUE(bench.stepUntil(kForceMove, State::ready));
    EXPECT_EQ(vector(force, "ForcesExceeded"), Vector3{});
    EXPECT_NEAR(vector(force, "ForcesMax").z, 19.0, 1e-6);
}

TEST_F(ForceMove, AForceThatIsThereAlreadyEndsItBeforeItMoves) {
    const auto from = bench.commandedPose().translation;
    press(30.0);
    ASSERT_TRUE(bench.start(kForceMove, downUntil(20)));
    ASSERT_TRUE(bench.stepUntil(kForceMove, State::ready));
    EXPECT_LE((bench.commandedPose().translation - from).norm(), 1e-9);
    EXPECT_NEAR(vector(force, "ForcesExceeded").z, 30.0, 1e-6);
}

TEST_F(ForceMove, ASensorThatFailsStopsIt) {
    for (const bool silent : {true, false}) {
        sensor.now = {};
        sensor.now.health = SafetyState::normal;
        ASSERT_TRUE(bench.start(kForceMove, downUntil(20)));
        bench.steps(15);
        if (silent) {
            sensor.now.health = SafetyState::disconnected;
        } else {
            sensor.now.force[1] = std::nan("");
        }
        ASSERT_TRUE(bench.stepUntil(kForceMove, State::halted));
        EXPECT_EQ(force.reason(), Reason::error);
        EXPECT_THAT(force.reasonText(), HasSubstr(silent ? "netft: silent" : "not finite"));
        sensor.now = {};
        sensor.now.health = SafetyState::normal;
        ASSERT_TRUE(force.reset(bench.caller()));
    }
}

TEST_F(ForceMove, KeepsTheFirstReasonOfASensorThatRecoversWhileTheArmBrakes) {
    ASSERT_TRUE(bench.start(kForceMove, downUntil(20)));
    bench.steps(15);
    sensor.become(SafetyState::fault, "netft: saturation");
    bench.steps(1);
    sensor.become(SafetyState::disconnected, "netft: no record");
    bench.steps(1);
    sensor.become(SafetyState::normal);
    ASSERT_TRUE(bench.stepUntil(kForceMove, State::halted));
    EXPECT_EQ(force.reasonText(), "netft failed during the motion: netft: saturation");
}

TEST_F(ForceMove, TellsWhatASensorWasThatIsWellAgainBeforeItSaysWhy) {
    ASSERT_TRUE(bench.start(kForceMove, downUntil(20)));
    sensor.become(SafetyState::fault, "netft: saturation");
    sensor.become(SafetyState::normal);
    bench.steps(15);
    sensor.now.health = SafetyState::disconnected;
    bench.steps(1);
    sensor.become(SafetyState::normal);
    ASSERT_TRUE(bench.stepUntil(kForceMove, State::halted));
    EXPECT_EQ(force.reasonText(),
              "netft failed during the motion: disconnected for a moment, and well again");
}

TEST_F(ForceMove, DoesNotBeginWithoutItsSensor) {
    sensor.now.health = SafetyState::disconnected;
    EXPECT_THAT(bench.start(kForceMove, downUntil(20)).error().message, HasSubstr("netft"));
}

TEST_F(ForceMove, CanBeSuspendedAndResumed) {
    ASSERT_TRUE(bench.start(kForceMove, downUntil(20)));
    bench.steps(15);
    ASSERT_TRUE(force.suspend(bench.caller()));
    ASSERT_TRUE(bench.stepUntil(kForceMove, State::suspended));
    ASSERT_TRUE(force.resume(bench.caller()));
    EXPECT_TRUE(bench.stepUntil(kForceMove, State::ready));
}

TEST_F(ForceMove, ItsCycleDoesNotAllocate) {
    ASSERT_TRUE(bench.start(kForceMove, downUntil(20)));
    auto& arm = bench.arm();
    const auto before = allocationCount();
    for (int i = 0; i < 20; ++i) {
        arm.cycle(SteadyTime(arm.info().cycle * i), 0);
    }
    sensor.now.force = {50.0, 50.0, 50.0};
    for (int i = 20; i < 200; ++i) {
        arm.cycle(SteadyTime(arm.info().cycle * i), 0);
    }
    EXPECT_EQ(allocationCount(), before);
    bench.step();
    EXPECT_EQ(force.state(), State::ready);
}

// ---- by a planner's arm and its sensor ----------------------------------------------------------

class ForceMoveBesideAPlanner : public ::testing::Test {
protected:
    ForceMoveBesideAPlanner() {
        // Turned by 0.3 rad about y: no axis of the flange is one of the base frame's.
        EXPECT_TRUE(bench.start(kCartesianLinear, {{"TargetPosition", Frame{0, 0, 0, 0, 0.3, 0}},
                                                   {"Relative", std::int32_t{1}}}));
        EXPECT_TRUE(bench.stepUntil(kCartesianLinear, State::ready));
    }
    /// Steps against a wall 5 cm below the start, as stiff as 5 N/mm.
    bool meetsWall(State until) {
        const double wall = bench.commandedPose().translation.z() - 0.05;
        return bench.stepUntil([&] {
            const auto pose = bench.commandedPose();
            const double depth = std::max(0.0, wall - pose.translation.z());
            const Eigen::Vector3d in_flange =
                pose.rotation.inverse() * Eigen::Vector3d(0, 0, 5000.0 * depth);
            sensor.now.force = {in_flange.x(), in_flange.y(), in_flange.z()};
            return force.state() == until;
        });
    }

    GivenSensor sensor;
    ControllerPlannedBench planned{"iiwa7", &sensor};
    Bench& bench = planned.bench;
    skill::Program& force = bench.program(kForceMove);
};

TEST_F(ForceMoveBesideAPlanner, EndsAtAContactAlongAnyAxis) {
    const double from = bench.commandedPose().translation.z();
    ASSERT_TRUE(bench.start(kForceMove, downUntil(20, kSlowly)));
    ASSERT_TRUE(meetsWall(State::ready));
    EXPECT_TRUE(planned.planner().asked.empty()) << "the controller watches its flange's axes only";
    EXPECT_GT(vector(force, "ForcesExceeded").z, 20.0);
    EXPECT_NEAR(vector(force, "ForcesExceeded").x, 0.0, 1e-3);
    const auto reached = std::get<Frame>(force.finalResult().at("ReachedPose"));
    EXPECT_LT(reached.z, from - 0.054) << "20 N at 5 N/mm";
    EXPECT_GT(reached.z, from - 0.057) << "and not much deeper";
}

TEST_F(ForceMoveBesideAPlanner, IsHaltedByTheForceWhereThatIsAnError) {
    ASSERT_TRUE(bench.start(kForceMove, downUntil(20, {{"HaltOnForce", true}})));
    ASSERT_TRUE(meetsWall(State::halted));
    EXPECT_EQ(force.subState(), SubState::halted_force);
}

TEST_F(ForceMoveBesideAPlanner, ReportsItsStoppingTime) {
    ASSERT_TRUE(bench.start(kForceMove, downUntil(20, {{"Duration", 3.0}})));
    bench.steps(100);
    ASSERT_TRUE(bench.stoppingEstimate());
    EXPECT_GT(bench.stoppingEstimate()->time.count(), 0.0);
}

TEST_F(ForceMoveBesideAPlanner, TakesItsDuration) {
    ASSERT_TRUE(bench.start(kForceMove, downUntil(20, {{"Duration", 3.0}})));
    ASSERT_TRUE(bench.stepUntil(kForceMove, State::ready));
    EXPECT_NEAR(std::get<double>(force.finalResult().at("Duration")), 3.0, 0.002);
}

TEST(ForceMoveOfABareArm, IsNotThere) {
    Bench bench;
    EXPECT_THROW(bench.program(kForceMove), std::out_of_range);
}

}  // namespace
}  // namespace metier::robot_skills
