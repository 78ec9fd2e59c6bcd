// The time in which an arm would stand is published before a stop, and is kept.
#include "metier/robot_skills/stopping_report.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <random>

#include "bench.hpp"

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

}  // namespace
}  // namespace metier::robot_skills
