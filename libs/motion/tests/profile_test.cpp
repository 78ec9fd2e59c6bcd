#include "metier/motion/profile.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace metier::motion {
namespace {

constexpr ScalarLimits kLimits{0.25, 1.2, 25.0};

/// Largest of |v|, |a| relative to the limits while the profile runs.
ScalarLimits usedShare(const Profile& profile, const ScalarLimits& limits) {
    ScalarLimits share;
    for (int i = 0; i <= 2000; ++i) {
        const double time = profile.duration() * i / 2000.0;
        const ScalarState state = profile.at(time);
        share.velocity = std::max(share.velocity, std::abs(state.velocity) / limits.velocity);
        share.acceleration =
            std::max(share.acceleration, std::abs(state.acceleration) / limits.acceleration);
        share.jerk = std::max(share.jerk, std::abs(profile.jerkAt(time)) / limits.jerk);
    }
    return share;
}

TEST(Profile, FromRestTakesTheTimeTheLimitsDictate) {
    const Profile profile = Profile::toRest({}, 0.1, kLimits);
    EXPECT_NEAR(profile.duration(), 0.1 / 0.25 + 0.25 / 1.2 + 1.2 / 25, 1e-12);
    const ScalarLimits share = usedShare(profile, kLimits);
    EXPECT_LE(share.velocity, 1 + 1e-12);
    EXPECT_LE(share.acceleration, 1 + 1e-12);
    EXPECT_LE(share.jerk, 1);
}

TEST(Profile, ReachesTheTargetExactlyAtRest) {
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> exponent(-12, 3);
    for (int i = 0; i < 1000; ++i) {
        const double target = std::pow(10.0, exponent(random));
        const Profile profile = Profile::toRest({}, target, kLimits);
        const ScalarState just_before = profile.at(profile.duration() * (1 - 1e-12));
        EXPECT_NEAR(just_before.position, target, 1e-9 * target + 1e-14);
        EXPECT_EQ(profile.at(profile.duration()).position, target);
        EXPECT_EQ(profile.at(profile.duration()).velocity, 0.0);
    }
}

TEST(Profile, StaysWhereItIsForNoDistance) {
    const Profile profile = Profile::toRest({0.3, 0, 0}, 0.3, kLimits);
    EXPECT_EQ(profile.duration(), 0.0);
    EXPECT_EQ(profile.at(1.0).position, 0.3);
}

TEST(Profile, FromAnyStateComesToRestAtTheTargetWithinTheLimits) {
    std::mt19937_64 random(2);
    std::uniform_real_distribution<double> unit(-1, 1);
    for (int i = 0; i < 5000; ++i) {
        ScalarState start{unit(random), 0, kLimits.acceleration * unit(random)};
        const double from_acceleration =
            start.acceleration * std::abs(start.acceleration) / (2 * kLimits.jerk);
        start.velocity = kLimits.velocity * unit(random) * 0.85;
        if (std::abs(start.velocity + from_acceleration) > kLimits.velocity) {
            continue;
        }
        const double target = unit(random);
        const Profile profile = Profile::toRest(start, target, kLimits);
        const ScalarState end = profile.at(profile.duration() - 1e-13);
        ASSERT_NEAR(end.position, target, 1e-9);
        ASSERT_NEAR(end.velocity, 0, 1e-9);
        const ScalarLimits share = usedShare(profile, kLimits);
        ASSERT_LE(share.velocity, 1 + 1e-9);
        ASSERT_LE(share.acceleration, 1 + 1e-9);
    }
}

TEST(Profile, BrakesWithinVelocityOverAccelerationPlusAccelerationOverJerk) {
    const Profile profile = Profile::brake({0, 0.25, 0}, kLimits);
    EXPECT_NEAR(profile.duration(), 0.25 / 1.2 + 1.2 / 25, 1e-12);
    EXPECT_NEAR(profile.end(), 0.25 * 0.25 / 2.4 + 0.25 * 1.2 / 50, 1e-12);
}

TEST(Profile, SlowsDownFromAVelocityOverALoweredLimit) {
    const Profile profile = Profile::toRest({0, 0.25, 0}, 1.0, {0.1, 1.2, 25});
    EXPECT_NEAR(profile.at(0.5).velocity, 0.1, 1e-12);
    EXPECT_EQ(profile.at(profile.duration()).position, 1.0);
}

}  // namespace
}  // namespace metier::motion
