#include "metier/motion/pose.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "metier/motion/rotation.hpp"

namespace metier::motion {
namespace {

Pose randomPose(std::mt19937_64& random) {
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    const Eigen::Vector3d translation(unit(random), unit(random), unit(random));
    const Eigen::Vector3d turn(unit(random), unit(random), unit(random));
    return {translation, fromRotationVector(3.0 * turn)};
}

TEST(Pose, InverseUndoesThePose) {
    std::mt19937_64 random(1);
    for (int i = 0; i < 1000; ++i) {
        const Pose pose = randomPose(random);
        const Pose identity = pose * pose.inverse();
        EXPECT_LT(identity.translation.norm(), 1e-14);
        EXPECT_LT(rotationAngleBetween(identity.rotation, Eigen::Quaterniond::Identity()), 1e-14);
    }
}

TEST(Pose, ComposesAsTheHomogeneousMatricesDo) {
    std::mt19937_64 random(2);
    for (int i = 0; i < 1000; ++i) {
        const Pose a = randomPose(random);
        const Pose b = randomPose(random);
        const Eigen::Vector3d point(0.1, -0.2, 0.3);
        EXPECT_LT(((a * b) * point - a * (b * point)).norm(), 1e-14);
    }
}

TEST(Pose, TurnsAPointAboutTheOriginOfTheTarget) {
    const Pose pose{{1, 2, 3}, fromRotationVector({0, 0, std::numbers::pi / 2})};
    EXPECT_LT((pose * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(1, 3, 3)).norm(), 1e-14);
}

TEST(Pose, StaysAUnitQuaternionOverManyCompositions) {
    std::mt19937_64 random(3);
    Pose pose;
    for (int i = 0; i < 100000; ++i) {
        pose = pose * randomPose(random);
    }
    EXPECT_NEAR(pose.rotation.norm(), 1.0, 1e-15);
}

}  // namespace
}  // namespace metier::motion
