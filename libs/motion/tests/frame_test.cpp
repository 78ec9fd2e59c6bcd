#include "metier/motion/frame.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "metier/motion/rotation.hpp"

namespace metier::motion {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(Frame, RotatesAboutXFirstThenYThenZ) {
    const Pose pose = toPose({0, 0, 0, kPi / 2, 0, kPi / 2});
    EXPECT_LT((pose * Eigen::Vector3d::UnitY() - Eigen::Vector3d::UnitZ()).norm(), 1e-15);
    EXPECT_LT((pose * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitY()).norm(), 1e-15);
}

TEST(Frame, GivesBackTheAnglesOfAPose) {
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> turn(-3.1, 3.1);
    std::uniform_real_distribution<double> half(-1.55, 1.55);
    for (int i = 0; i < 10000; ++i) {
        const Frame frame{1, 2, 3, turn(random), half(random), turn(random)};
        const Frame back = toFrame(toPose(frame));
        EXPECT_NEAR(back.a, frame.a, 1e-12);
        EXPECT_NEAR(back.b, frame.b, 1e-12);
        EXPECT_NEAR(back.c, frame.c, 1e-12);
        EXPECT_EQ(back.z, 3);
    }
}

TEST(Frame, DescribesTheSameRotationCloseToGimbalLock) {
    std::mt19937_64 random(2);
    std::uniform_real_distribution<double> turn(-3.1, 3.1);
    for (double off = 1e-14; off < 1e-2; off *= 3) {
        for (const double b : {kPi / 2 - off, off - kPi / 2}) {
            const Pose pose = toPose({0, 0, 0, turn(random), b, turn(random)});
            EXPECT_LT(rotationAngleBetween(toPose(toFrame(pose)).rotation, pose.rotation), 5e-12)
                << off;
        }
    }
}

TEST(Frame, DescribesTheSameRotationAtGimbalLock) {
    for (const double b : {kPi / 2, -kPi / 2}) {
        for (double a = -3.0; a < 3.1; a += 0.5) {
            const Pose pose = toPose({0, 0, 0, a, b, 0.7});
            const Frame frame = toFrame(pose);
            EXPECT_LT(rotationAngleBetween(toPose(frame).rotation, pose.rotation), 1e-8);
            EXPECT_TRUE(std::isfinite(frame.c));
        }
    }
}

}  // namespace
}  // namespace metier::motion
