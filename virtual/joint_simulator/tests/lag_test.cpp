#include "metier/joint_simulator/lag.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace metier::joint_simulator {
namespace {

using device::JointArray;

constexpr double kCycle = 0.01;

JointArray at(double value) {
    JointArray joints(1);
    joints[0] = value;
    return joints;
}

TEST(Lag, FollowsAtOnceWithoutDelayAndTimeConstant) {
    Lag lag(0, 0.0, kCycle);
    lag.reset(at(1.0));
    lag.advance(at(1.02));
    EXPECT_EQ(lag.position(), at(1.02));
    EXPECT_NEAR(lag.velocity()[0], 2.0, 1e-12);
}

TEST(Lag, FollowsTheSetPointOfSoManyCyclesAgo) {
    Lag lag(2, 0.0, kCycle);
    lag.reset(at(0.0));
    for (int i = 1; i <= 5; ++i) {
        lag.advance(at(0.1 * i));
    }
    EXPECT_NEAR(lag.position()[0], 0.3, 1e-12);
}

TEST(Lag, MakesGoodTwoThirdsOfAStepInItsTimeConstant) {
    Lag lag(0, 10 * kCycle, kCycle);
    lag.reset(at(0.0));
    for (int i = 0; i < 10; ++i) {
        lag.advance(at(1.0));
    }
    EXPECT_NEAR(lag.position()[0], 1.0 - std::exp(-1.0), 1e-12);
}

TEST(Lag, ArrivesExactly) {
    Lag lag(1, kCycle, kCycle);
    lag.reset(at(0.0));
    for (int i = 0; i < 40; ++i) {
        lag.advance(at(0.5));
    }
    EXPECT_EQ(lag.position(), at(0.5));
    EXPECT_EQ(lag.velocity(), at(0.0));
}

}  // namespace
}  // namespace metier::joint_simulator
