#include "metier/virtual_controller/trapezoid.hpp"

#include <gtest/gtest.h>

#include <random>

namespace metier::virtual_controller {
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

TEST(Trapezoid, GoesFromNoughtToOneAndNeverBackOrTooFast) {
    Decades decades;
    for (int round = 0; round < kRounds; ++round) {
        const double velocity = decades.next(1e-3, 1e3);
        const double acceleration = decades.next(1e-3, 1e4);
        const Trapezoid profile(1.0, velocity, acceleration);
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

TEST(Trapezoid, SpeedsUpAndSlowsDownWithItsAcceleration) {
    Decades decades;
    for (int round = 0; round < kRounds; ++round) {
        const double acceleration = decades.next(1e-3, 1e4);
        const Trapezoid profile(1.0, decades.next(1e-3, 1e3), acceleration);
        const double early = (profile.duration() - profile.brakingFrom()) / 2.0;
        EXPECT_NEAR(profile.at(early), acceleration * early * early / 2.0, 1e-9);
        EXPECT_NEAR(1.0 - profile.at(profile.duration() - early), profile.at(early), 1e-9);
        EXPECT_GE(profile.brakingFrom(), profile.duration() / 2.0 - 1e-12);
    }
}

TEST(Trapezoid, TakesTheTimeOfATrapezoidOrATriangle) {
    EXPECT_NEAR(Trapezoid(1.0, 0.5, 1.0).duration(), 2.5, 1e-12);    // 1/v + v/a
    EXPECT_NEAR(Trapezoid(1.0, 100.0, 4.0).duration(), 1.0, 1e-12);  // 2 sqrt(1/a)
}

TEST(Trapezoid, LastsAsLongAsItIsAskedFor) {
    const auto profile = Trapezoid(2.0, 1.0, 1.0).lasting(6.0);
    EXPECT_EQ(profile.duration(), 6.0);
    EXPECT_NEAR(profile.at(3.0), 1.0, 1e-12);
    EXPECT_NEAR(profile.at(2.0), 0.5, 1e-12);
    EXPECT_EQ(profile.at(6.0), 2.0);
    EXPECT_EQ(Trapezoid(0.0, 1.0, 1.0).lasting(6.0).duration(), 6.0);
}

}  // namespace
}  // namespace metier::virtual_controller
