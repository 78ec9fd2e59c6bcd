#include "metier/motion/rotation.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

namespace metier::motion {
namespace {

constexpr double kPi = std::numbers::pi;

Eigen::Vector3d randomDirection(std::mt19937_64& random) {
    std::normal_distribution<double> normal;
    return Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
}

TEST(Rotation, GivesBackARotationVectorUpToAHalfTurn) {
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> angle(0.0, kPi - 1e-6);
    for (int i = 0; i < 10000; ++i) {
        const Eigen::Vector3d vector = angle(random) * randomDirection(random);
        EXPECT_LT((toRotationVector(fromRotationVector(vector)) - vector).norm(), 1e-12);
    }
}

TEST(Rotation, IsExactForTinyAngles) {
    const Eigen::Vector3d vector(1e-12, -2e-12, 3e-13);
    EXPECT_LT((toRotationVector(fromRotationVector(vector)) - vector).norm(), 1e-26);
}

TEST(Rotation, TakesTheShortWayWhateverTheSignsOfTheQuaternions) {
    std::mt19937_64 random(2);
    for (int i = 0; i < 10000; ++i) {
        const Eigen::Quaterniond from = fromRotationVector(3.0 * randomDirection(random));
        const Eigen::Quaterniond to(-fromRotationVector(2.0 * randomDirection(random)).coeffs());
        const Eigen::Vector3d between = rotationVectorBetween(from, to);
        EXPECT_LE(between.norm(), kPi + 1e-15);
        EXPECT_LT(rotationAngleBetween(fromRotationVector(between) * from, to), 1e-14);
        EXPECT_NEAR(rotationAngleBetween(slerp(from, to, 0.25), from), between.norm() / 4, 1e-14);
    }
}

TEST(Rotation, ChoosesTheSameAxisForEveryHalfTurn) {
    std::mt19937_64 random(3);
    for (int i = 0; i < 10000; ++i) {
        const Eigen::Vector3d axis = randomDirection(random);
        const Eigen::Vector3d there = toRotationVector(fromRotationVector(kPi * axis));
        const Eigen::Vector3d back = toRotationVector(fromRotationVector(-kPi * axis));
        EXPECT_LT((there - back).norm(), 1e-12);
        EXPECT_GT(there.x(), -1e-9);
    }
}

TEST(Rotation, SlerpStartsAndEndsAtTheGivenRotations) {
    const Eigen::Quaterniond from = fromRotationVector({0.1, 0.2, 0.3});
    const Eigen::Quaterniond to = fromRotationVector({-2.0, 1.0, 0.5});
    EXPECT_LT(rotationAngleBetween(slerp(from, to, 0.0), from), 1e-15);
    EXPECT_LT(rotationAngleBetween(slerp(from, to, 1.0), to), 1e-15);
}

}  // namespace
}  // namespace metier::motion
