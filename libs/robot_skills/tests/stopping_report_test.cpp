// The time in which an arm would stand is published before a stop, and is kept.
#include "metier/robot_skills/stopping_report.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <random>

#include "controller_planned_bench.hpp"
#include "given_sensor.hpp"

namespace metier::robot_skills {
namespace {

using skill::State;
using skill::ValueMap;

class Stopping : public ::testing::TestWithParam<const char*> {
protected:
    /// A turn of axis 1 that is under way, half of them slow ones.
    void start() {
        auto target = home_;
        target[0] += part() > 0.5 ? 0.5 : -0.5;
        ValueMap values{{"TargetJointPosition", std::vector<double>(target.begin(), target.end())}};
        if (part() > 0.5) {
            values["Duration"] = 2.0 + 20.0 * part();
        }
        const auto report = bench.program(kJointPtp).check(bench.caller(), values);
        ASSERT_TRUE(report.possible) << report.reason;
        most_ = {motion::Seconds(report.stopping_time), report.stopping_distance};
        ASSERT_TRUE(bench.start(kJointPtp, values));
        const auto cycles = report.planned_duration / bench.arm().info().cycleSeconds();
        bench.steps(2 + static_cast<int>((0.05 + 0.8 * part()) * cycles));
    }
    double part() { return std::uniform_real_distribution<double>()(random_); }

    Bench bench{GetParam()};
    motion::StoppingEstimate most_;  ///< of the motion, by Check

private:
    const motion::JointVector home_ = bench.commanded();
    std::mt19937 random_{7};
};

TEST_P(Stopping, TakesNoLongerThanWasTold) {
    const auto cycle = bench.arm().info().cycleSeconds();
    for (int i = 0; i < 30; ++i) {
        EXPECT_FALSE(bench.stoppingEstimate()) << "nothing moves";
        start();
        const auto told = bench.stoppingEstimate();
        ASSERT_TRUE(told);
        const auto from = bench.commandedPose();
        ASSERT_TRUE(bench.program(kJointPtp).halt(bench.caller()));
        int cycles = -1;
        auto before = from;
        do {
            before = bench.commandedPose();
            bench.step();
            ++cycles;
        } while (motion::distanceBetween(before, bench.commandedPose()) > 0.0);
        EXPECT_LE(cycles * cycle, told->time.count() + 2 * cycle);
        EXPECT_LE(motion::distanceBetween(from, bench.commandedPose()), told->distance + 1e-6);
        EXPECT_LE(told->time.count(), 1.05 * most_.time.count());
        EXPECT_LE(told->distance, 1.05 * most_.distance);
        ASSERT_TRUE(bench.stepUntil(kJointPtp, State::halted));
        ASSERT_TRUE(bench.program(kJointPtp).reset(bench.caller()));
    }
}

INSTANTIATE_TEST_SUITE_P(Arms, Stopping, ::testing::Values("ur5", "iiwa7", "edo"),
                         [](const auto& arm) { return std::string(arm.param); });

TEST(StoppingEstimate, OfAMeasuredVelocityIsThatOfTheSlowestAxis) {
    const auto model = modelOf("ur5");
    device::ArmState state;
    state.position = device::JointArray(model.axisCount());
    state.velocity = device::JointArray(model.axisCount());
    state.velocity[0] = -1.0;
    state.velocity[1] = 1e-4;
    state.standstill = false;
    const auto& limits = model.limits(0);
    const auto way = stoppingEstimateOf(state, model);
    EXPECT_NEAR(way.time.count(), 1.0 / limits.acceleration + limits.acceleration / limits.jerk,
                1e-12);
    EXPECT_GT(way.distance, 0.0);
    state.velocity[0] = 0.0;
    EXPECT_NEAR(stoppingEstimateOf(state, model).time.count(),
                2 * std::sqrt(1e-4 / model.limits(1).jerk), 1e-12);
    state.standstill = true;
    EXPECT_EQ(stoppingEstimateOf(state, model).time.count(), 0.0);
}

TEST(StoppingEstimate, IncludesTheAccelerationThatEndsFirst) {
    const auto model = modelOf("iiwa7");
    const auto& limits = model.limits(0);
    device::ArmState state;
    state.position = device::JointArray(model.home().span());
    state.velocity = device::JointArray(model.axisCount());
    device::JointArray acceleration(model.axisCount());
    acceleration[0] = limits.acceleration;
    const double ends = limits.acceleration / limits.jerk;
    const double gained = 0.5 * limits.acceleration * ends;
    EXPECT_NEAR(stoppingEstimateOf(state, model, acceleration).time.count(),
                ends + 2.0 * std::sqrt(gained / limits.jerk), 1e-9);
    EXPECT_GT(stoppingEstimateOf(state, model, acceleration).distance, 0.0);
    EXPECT_EQ(stoppingEstimateOf(state, model).time.count(), 0.0) << "at rest without a motion";
}

// ---- motions of a controller's planner ----------------------------------------------------------

class StoppingOfTheControllersMotion : public ::testing::Test {
protected:
    /// A turn of axis 1 by 0.5 rad to one side and back.
    void start(double speed_override = 1.0) {
        auto target = home_;
        target[0] += (side_ = -side_) * 0.25;
        ASSERT_TRUE(bench.start(
            kJointPtp, {{"TargetJointPosition", std::vector<double>(target.begin(), target.end())},
                        {"SpeedOverride", speed_override}}));
    }
    void haltAndReset() {
        ASSERT_TRUE(bench.program(kJointPtp).halt(bench.caller()));
        ASSERT_TRUE(bench.stepUntil(kJointPtp, State::halted));
        ASSERT_TRUE(bench.program(kJointPtp).reset(bench.caller()));
    }
    double reported() const { return bench.stoppingEstimate().value().time.count(); }

    GivenSensor sensor;
    ControllerPlannedBench planned{"iiwa7", &sensor};
    Bench& bench = planned.bench;

private:
    const motion::JointVector home_ = bench.commanded();
    double side_ = 1.0;
};

TEST_F(StoppingOfTheControllersMotion, TakesNoLongerThanReportedAtAnyTimeOfIt) {
    // The measured velocities are those of some cycles ago.
    constexpr double kBehind = 4e-3;  // [m]
    const auto cycle = bench.arm().info().cycleSeconds();
    for (int after = 0; after < 500; after += 7) {
        start(after % 2 == 0 ? 1.0 : 0.3);
        bench.steps(after);
        const auto stop = bench.stoppingEstimate();
        ASSERT_TRUE(stop) << after;
        const auto from = bench.commandedPose();
        ASSERT_TRUE(bench.program(kJointPtp).halt(bench.caller()));
        int last = 0;
        for (int i = 1; bench.program(kJointPtp).state() != State::halted; ++i) {
            const auto before = bench.commandedPose();
            bench.step();
            last = motion::distanceBetween(before, bench.commandedPose()) > 0.0 ? i : last;
        }
        EXPECT_LE(last * cycle, stop->time.count() + 4 * cycle) << after;
        EXPECT_LE(motion::distanceBetween(from, bench.commandedPose()), stop->distance + kBehind)
            << after;
        ASSERT_TRUE(bench.program(kJointPtp).reset(bench.caller()));
    }
}

TEST_F(StoppingOfTheControllersMotion, IsThatOfTheMeasuredVelocityOnceTheSpeedIsSteady) {
    start(0.2);
    ASSERT_TRUE(bench.stepUntil([&] { return bench.arm().state().velocity[0] < -0.3; }));
    bench.steps(200);
    EXPECT_NEAR(reported(), stoppingEstimateOf(bench.arm().state(), bench.model()).time.count(),
                1e-3);
}

TEST_F(StoppingOfTheControllersMotion, IsNotLongerThanThatOfTheSpeedAndAccelerationItMayReach) {
    start(0.02);
    const auto& limits = bench.model().limits(0);
    const double speed = 0.02 * limits.velocity;
    EXPECT_GT(reported(), 2.0 * std::sqrt(speed / limits.jerk));
    EXPECT_LT(reported(), 3.5 * std::sqrt(speed / limits.jerk));
}

TEST_F(StoppingOfTheControllersMotion, IsNothingBeforeAndAfterIt) {
    EXPECT_FALSE(bench.stoppingEstimate());
    start();
    EXPECT_GT(reported(), 0.0);
    ASSERT_TRUE(bench.stepUntil(kJointPtp, State::ready));
    EXPECT_FALSE(bench.stoppingEstimate());
    EXPECT_EQ(stoppingEstimateOf(bench.arm().state(), bench.model()).time.count(), 0.0);
    planned.planner().behaviour.refuses = Error{Errc::device_fault, "not ready to move"};
    start();
    EXPECT_FALSE(bench.stoppingEstimate()) << "refused";
}

TEST_F(StoppingOfTheControllersMotion, IsThereAgainWhenItIsResumed) {
    start();
    bench.steps(200);
    ASSERT_TRUE(bench.program(kJointPtp).suspend(bench.caller()));
    ASSERT_TRUE(bench.stepUntil(kJointPtp, State::suspended));
    EXPECT_FALSE(bench.stoppingEstimate());
    ASSERT_TRUE(bench.program(kJointPtp).resume(bench.caller()));
    EXPECT_GT(reported(), 0.2);
    haltAndReset();
}

TEST_F(StoppingOfTheControllersMotion, IsReportedForAForceMoveThatMetierStreamsBesideThePlanner) {
    ASSERT_TRUE(bench.start(kForceMove, {{"TargetPosition", skill::Frame{0, 0, -0.1}},
                                         {"Relative", std::int32_t{1}},
                                         {"MaxForce", skill::Vector3{0, 0, 20}},
                                         {"Duration", 3.0}}));
    bench.steps(500);
    EXPECT_TRUE(planned.planner().asked.empty());
    EXPECT_TRUE(bench.stoppingEstimate());
}

}  // namespace
}  // namespace metier::robot_skills
