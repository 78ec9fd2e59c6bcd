// Speed profiles, paths and poses: invariants over random inputs.
#include "segment.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "movement.hpp"

namespace metier::virtual_edo {
namespace {

constexpr int kRounds = 200;

/// Numbers evenly spread over decades.
class Decades {
public:
    double next(double least, double most) {
        return std::pow(
            10.0, std::uniform_real_distribution<>(std::log10(least), std::log10(most))(random_));
    }

private:
    std::mt19937 random_{3};  // NOLINT: the same numbers at each run
};

TEST(SpeedProfile, GoesFromNoughtToOneAndNeverBackOrTooFast) {
    Decades decades;
    for (int round = 0; round < kRounds; ++round) {
        const double velocity = decades.next(1e-3, 1e3);
        const double acceleration = decades.next(1e-3, 1e4);
        const SpeedProfile profile(velocity, acceleration);
        constexpr int kSteps = 500;
        const double step = profile.duration() / kSteps;
        double before = profile.at(0.0);
        EXPECT_EQ(before, 0.0);
        for (int i = 1; i <= kSteps; ++i) {
            const double place = profile.at(i * step);
            ASSERT_GE(place, before - 1e-12) << velocity << ' ' << acceleration;
            ASSERT_LE((place - before) / step, velocity * (1.0 + 1e-9) + 1e-9)
                << velocity << ' ' << acceleration;
            before = place;
        }
        EXPECT_NEAR(before, 1.0, 1e-9);
        EXPECT_EQ(profile.at(profile.duration() + 1.0), 1.0);
        EXPECT_EQ(profile.at(-1.0), 0.0);
    }
}

TEST(SpeedProfile, SpeedsUpAndSlowsDownWithItsAcceleration) {
    Decades decades;
    for (int round = 0; round < kRounds; ++round) {
        const double acceleration = decades.next(1e-3, 1e4);
        const SpeedProfile profile(decades.next(1e-3, 1e3), acceleration);
        const double early = (profile.duration() - profile.brakingFrom()) / 2.0;
        EXPECT_NEAR(profile.at(early), acceleration * early * early / 2.0, 1e-9);
        EXPECT_NEAR(1.0 - profile.at(profile.duration() - early), profile.at(early), 1e-9);
        EXPECT_GE(profile.brakingFrom(), profile.duration() / 2.0 - 1e-12);
    }
}

TEST(SpeedProfile, TakesTheTimeOfATrapezoidOrATriangle) {
    EXPECT_NEAR(SpeedProfile(0.5, 1.0).duration(), 2.5, 1e-12);    // 1/v + v/a
    EXPECT_NEAR(SpeedProfile(100.0, 4.0).duration(), 1.0, 1e-12);  // 2 sqrt(1/a)
}

TEST(Segment, PassesItsPositionsAndIsExactAtItsEnds) {
    std::vector<AxisValues> path(4);
    for (std::size_t i = 0; i < path.size(); ++i) {
        path[i].fill(static_cast<double>(i * i) + 0.1);
    }
    const Segment segment(path, SpeedProfile(1e3, 4.0));
    EXPECT_EQ(segment.at(-1.0), path.front());
    EXPECT_EQ(segment.at(segment.duration()), path.back());
    EXPECT_EQ(segment.at(1e9), path.back());
    // A triangle of 1 s: half of the way at half of the time, between the positions 1 and 4.
    EXPECT_NEAR(segment.at(0.5)[3], 0.1 + (1.0 + 4.0) / 2.0, 1e-9);
    EXPECT_EQ(segment.start(), path.front());
    EXPECT_EQ(segment.end(), path.back());
}

TEST(CartesianPose, IsThePoseItWasMadeFrom) {
    std::mt19937 random(5);  // NOLINT: the same poses at each run
    std::uniform_real_distribution<> number(-1.0, 1.0);
    for (int round = 0; round < kRounds; ++round) {
        const motion::Pose pose{.translation = {number(random), number(random), number(random)},
                                .rotation = Eigen::Quaterniond(number(random), number(random),
                                                               number(random), number(random))
                                                .normalized()};
        const auto wire = toCartesian(pose);
        EXPECT_GE(wire.e, 0.0);
        EXPECT_LE(wire.e, 180.0);
        const auto back = toPose(wire);
        EXPECT_TRUE(back.translation.isApprox(pose.translation, 1e-12));
        EXPECT_NEAR(back.rotation.angularDistance(pose.rotation), 0.0, 1e-6);
    }
}

TEST(CartesianPose, HasOneTurnWhereOnlyTheSumOfTwoIsDefined) {
    const auto upright = toCartesian(toPose({.x = 1, .a = 30, .e = 0, .r = 25}));
    EXPECT_EQ(upright.a, 0.0);
    EXPECT_NEAR(upright.r, 55.0, 1e-9);
    const auto turned = toCartesian(toPose({.a = 30, .e = 180, .r = 25}));
    EXPECT_EQ(turned.a, 0.0);
    EXPECT_NEAR(turned.e, 180.0, 1e-9);
    const auto again = toPose(turned);
    EXPECT_NEAR(again.rotation.angularDistance(toPose({.a = 30, .e = 180, .r = 25}).rotation), 0.0,
                1e-6);
}

}  // namespace
}  // namespace metier::virtual_edo
