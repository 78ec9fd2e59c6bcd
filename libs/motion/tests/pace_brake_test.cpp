#include "metier/motion/pace_brake.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace metier::motion {
namespace {

TEST(PaceBrake, TakesHalfOfItsLengthOfThePlannedTime) {
    PaceBrake brake(0.4);
    double planned = 0;
    while (!brake.over()) {
        planned += brake.advance(0.003);
    }
    EXPECT_NEAR(planned, 0.2, 1e-12);
    EXPECT_EQ(brake.advance(0.1), 0.0);
    EXPECT_EQ(brake.remaining(), 0.0);
}

TEST(PaceBrake, DoesNotDependOnTheStepsThatItIsTakenIn) {
    PaceBrake fine(0.5);
    PaceBrake coarse(0.5);
    double planned = 0;
    for (int i = 0; i < 40; ++i) {
        planned += fine.advance(0.008);
    }
    EXPECT_NEAR(planned, coarse.advance(0.32), 1e-12);
}

TEST(PaceBrake, SlowsWithoutAJumpOfSpeedOrAcceleration) {
    const ScalarState cruise{1.0, 2.0, 0.0};
    PaceBrake brake(0.5);
    EXPECT_EQ(brake.slowed(cruise).velocity, 2.0);
    EXPECT_EQ(brake.slowed(cruise).acceleration, 0.0);
    constexpr double step = 1e-4;
    auto before = brake.slowed(cruise);
    while (!brake.over()) {
        brake.advance(step);
        const auto now = brake.slowed(cruise);
        EXPECT_NEAR(now.velocity - before.velocity,
                    (now.acceleration + before.acceleration) / 2 * step, 1e-8);
        EXPECT_LE(std::abs(now.acceleration), 1.5 * 2.0 / 0.5 + 1e-9);
        EXPECT_LE(std::abs(now.acceleration - before.acceleration), 6 * 2.0 / 0.25 * step + 1e-9);
        before = now;
    }
    EXPECT_EQ(before.velocity, 0.0);
    EXPECT_EQ(before.acceleration, 0.0);
}

}  // namespace
}  // namespace metier::motion
