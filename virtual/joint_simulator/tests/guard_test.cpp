#include "metier/joint_simulator/guard.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace metier::joint_simulator {
namespace {

using device::JointArray;
using Quantity = Violation::Quantity;

constexpr double kCycle = 0.01;

Guard twoAxisGuard() {
    const AxisLimits limits{-1.0, 1.0, 1.0, 10.0};
    return {{limits, limits}, GuardTolerance{}, kCycle};
}

JointArray at(double first, double second) {
    JointArray joints(2);
    joints[0] = first;
    joints[1] = second;
    return joints;
}

TEST(Guard, TakesSetPointsWithinEveryLimit) {
    auto guard = twoAxisGuard();
    EXPECT_FALSE(guard.accept(at(0.001, -0.001)));
    EXPECT_FALSE(guard.accept(at(0.003, -0.003)));
    EXPECT_EQ(guard.position(), at(0.003, -0.003));
    EXPECT_NEAR(guard.velocity()[0], 0.2, 1e-12);
}

TEST(Guard, NamesTheAxisThatBreaksItsAcceleration) {
    auto guard = twoAxisGuard();
    const auto violation = guard.accept(at(0.0, 0.00106));  // 10.6 rad/s2, 5 % tolerance
    ASSERT_TRUE(violation);
    EXPECT_EQ(violation->quantity, Quantity::acceleration);
    EXPECT_EQ(violation->axis, 1U);
    EXPECT_NEAR(violation->value, 10.6, 1e-9);
    EXPECT_EQ(toText(*violation), "axis 2: acceleration 10.6000 rad/s2 over limit 10.0000 rad/s2");
    EXPECT_EQ(guard.position(), at(0.0, 0.0)) << "a refused set-point is not taken";
}

TEST(Guard, AllowsAnAccelerationWithinItsTolerance) {
    EXPECT_FALSE(twoAxisGuard().accept(at(0.0, 0.00104)));
}

TEST(Guard, NamesTheAxisThatBreaksItsVelocity) {
    auto guard = twoAxisGuard();
    double position = 0.0;
    for (int i = 1; i <= 10; ++i) {
        position += 0.1 * i * kCycle;
        ASSERT_FALSE(guard.accept(at(position, 0.0)));
    }
    EXPECT_FALSE(guard.accept(at(position + 1.009 * kCycle, 0.0)));
    const auto violation = guard.accept(at(guard.position()[0] + 1.02 * kCycle, 0.0));
    ASSERT_TRUE(violation);
    EXPECT_EQ(toText(*violation), "axis 1: velocity 1.0200 rad/s over limit 1.0000 rad/s");
}

TEST(Guard, NamesTheAxisThatLeavesItsRange) {
    auto guard = twoAxisGuard();
    guard.reset(at(0.0, 1.0));
    const auto violation = guard.accept(at(0.0, 1.0005));
    ASSERT_TRUE(violation);
    EXPECT_EQ(toText(*violation), "axis 2: position 1.0005 rad beyond limit 1.0000 rad");
    guard.reset(at(-1.0, 0.0));
    EXPECT_EQ(guard.accept(at(-1.0005, 0.0))->limit, -1.0);
}

TEST(Guard, RefusesWhatIsNoNumber) {
    const auto violation = twoAxisGuard().accept(at(0.0, std::numeric_limits<double>::quiet_NaN()));
    ASSERT_TRUE(violation);
    EXPECT_EQ(violation->quantity, Quantity::not_finite);
    EXPECT_EQ(toText(*violation), "axis 2: set-point is not finite");
}

TEST(Guard, RefusesAnotherNumberOfAxes) {
    const auto violation = twoAxisGuard().accept(JointArray(3));
    ASSERT_TRUE(violation);
    EXPECT_EQ(toText(*violation), "set-point has 3 values, the arm has 2 axes");
}

TEST(Guard, BrakesEachAxisAtItsAccelerationLimit) {
    auto guard = twoAxisGuard();
    ASSERT_FALSE(guard.accept(at(0.001, 0.0005)));
    ASSERT_FALSE(guard.accept(at(0.0025, 0.001)));  // 0.15 and 0.05 rad/s
    guard.brake();
    EXPECT_NEAR(guard.velocity()[0], 0.05, 1e-12);
    EXPECT_NEAR(guard.velocity()[1], 0.0, 1e-12);
    EXPECT_FALSE(guard.standing());
    guard.brake();
    EXPECT_TRUE(guard.standing());
    EXPECT_NEAR(guard.position()[0], 0.003, 1e-12);
}

}  // namespace
}  // namespace metier::joint_simulator
