#include "jaws.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace metier::virtual_wsg50 {
namespace {

constexpr double kStep = 0.002;
constexpr double kStroke = 0.110;

TEST(Jaws, DriveToTheTargetWithinSpeedAndAcceleration) {
    Jaws jaws(kStroke, 0.1);
    jaws.acceleration = 2.0;
    jaws.moveTo(0.02, 0.2);
    double before = 0.0;
    int steps = 0;
    for (; !jaws.arrived() && steps < 10'000; ++steps) {
        jaws.step(kStep, {});
        EXPECT_LE(std::abs(jaws.velocity()), 0.2 + 1e-9);
        if (!jaws.arrived()) {
            EXPECT_LE(std::abs(jaws.velocity() - before), 2.0 * kStep + 1e-9);
        }
        before = jaws.velocity();
    }
    EXPECT_EQ(jaws.width(), 0.02);
    EXPECT_NEAR(steps * kStep, 0.08 / 0.2 + 0.2 / 2.0, 0.02);
}

TEST(Jaws, StopAtAPartAndPressAgainstIt) {
    Jaws jaws(kStroke, 0.1);
    jaws.moveTo(0.02, 0.2);
    for (int i = 0; i < 1000; ++i) {
        jaws.step(kStep, {.part = 0.04});
    }
    EXPECT_EQ(jaws.width(), 0.04);
    EXPECT_EQ(jaws.contact(), Jaws::Contact::closing);
    for (int i = 0; i < 1000; ++i) {
        jaws.step(kStep, {});
    }
    EXPECT_EQ(jaws.width(), 0.02);
    EXPECT_EQ(jaws.contact(), Jaws::Contact::none);
}

TEST(Jaws, DoNotNoticeAPartThatIsWiderThanTheyAreOpen) {
    Jaws jaws(kStroke, 0.03);
    jaws.moveTo(0.01, 0.2);
    for (int i = 0; i < 1000; ++i) {
        jaws.step(kStep, {.part = 0.04});
    }
    EXPECT_EQ(jaws.width(), 0.01);
}

TEST(Jaws, AreBlockedFromEitherSide) {
    for (const double start : {0.02, 0.08}) {
        Jaws jaws(kStroke, start);
        jaws.moveTo(0.1 - start, 0.2);
        for (int i = 0; i < 1000; ++i) {
            jaws.step(kStep, {.part = {}, .block = 0.05});
        }
        EXPECT_EQ(jaws.width(), 0.05);
    }
}

TEST(Jaws, StayWithinTheStrokeWhateverIsAskedOfThem) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> share(0.0, 1.0);
    Jaws jaws(kStroke, 0.05);
    for (int i = 0; i < 20'000; ++i) {
        if (random() % 20 == 0) {
            jaws.acceleration = 0.1 + 4.9 * share(random);
            jaws.moveTo(kStroke * share(random), 0.005 + 0.415 * share(random));
        } else if (random() % 20 == 0) {
            jaws.brake();
        }
        jaws.step(kStep, {});
        ASSERT_GE(jaws.width(), 0.0);
        ASSERT_LE(jaws.width(), kStroke);
    }
}

}  // namespace
}  // namespace metier::virtual_wsg50
