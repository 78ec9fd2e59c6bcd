#include "pose_math.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "fake_robot.hpp"

namespace metier::urscript {
namespace {

using std::numbers::pi;

constexpr double kTolerance = 1e-9;
constexpr Pose kIdentity{};

double length(const Pose& pose, std::size_t first) {
    return std::hypot(pose.value[first], pose.value[first + 1], pose.value[first + 2]);
}

/// Places within 2 m with any rotation of at most half a turn.
class RandomPoses {
public:
    Pose next() {
        Pose pose;
        for (double& part : pose.value) {
            part = uniform_(random_);
        }
        const double turn = length(pose, 3);
        for (std::size_t i = 3; i < pose.value.size() && turn > pi; ++i) {
            pose.value[i] *= pi / turn * 0.999;
        }
        return pose;
    }

private:
    std::mt19937 random_{11};  // NOLINT: the same poses at each run
    std::uniform_real_distribution<> uniform_{-2.0, 2.0};
};

/// Places are equal, and no turn leads from one rotation to the other.
void expectSame(const Pose& pose, const Pose& expected) {
    const Pose difference = subtracted(pose, expected);
    EXPECT_NEAR(length(difference, 0), 0.0, kTolerance);
    EXPECT_NEAR(length(difference, 3), 0.0, kTolerance);
}

TEST(UrscriptPoseMath, APoseAndItsInverseAreNoTransformation) {
    RandomPoses poses;
    for (int i = 0; i < 200; ++i) {
        const Pose pose = poses.next();
        expectSame(transformed(pose, inverted(pose)), kIdentity);
        expectSame(transformed(inverted(pose), pose), kIdentity);
        expectSame(inverted(inverted(pose)), pose);
    }
}

TEST(UrscriptPoseMath, TransformationsMayBeJoinedInAnyOrder) {
    RandomPoses poses;
    for (int i = 0; i < 200; ++i) {
        const Pose a = poses.next();
        const Pose b = poses.next();
        const Pose c = poses.next();
        expectSame(transformed(transformed(a, b), c), transformed(a, transformed(b, c)));
    }
}

TEST(UrscriptPoseMath, ADifferenceThatIsAddedGivesThePoseAgain) {
    RandomPoses poses;
    for (int i = 0; i < 200; ++i) {
        const Pose from = poses.next();
        const Pose to = poses.next();
        expectSame(added(subtracted(to, from), from), to);
    }
}

TEST(UrscriptPoseMath, InterpolationBeginsAndEndsAtItsPosesAndTurnsEvenly) {
    RandomPoses poses;
    for (int i = 0; i < 200; ++i) {
        const Pose from = poses.next();
        const Pose to = poses.next();
        expectSame(interpolated(from, to, 0.0), from);
        expectSame(interpolated(from, to, 1.0), to);
        const Pose half = interpolated(from, to, 0.5);
        EXPECT_NEAR(length(subtracted(half, from), 3), length(subtracted(to, half), 3), 1e-7);
        EXPECT_NEAR(length(subtracted(half, from), 0), length(subtracted(to, half), 0), kTolerance);
    }
}

TEST(UrscriptPoseMath, ResultsTurnByAtMostHalfATurn) {
    RandomPoses poses;
    for (int i = 0; i < 200; ++i) {
        EXPECT_LE(length(transformed(poses.next(), poses.next()), 3), pi + kTolerance);
    }
    const Pose turn{{0, 0, 0, 0, 0, 2}};
    EXPECT_NEAR(transformed(turn, turn).value[5], 4.0 - 2.0 * pi, kTolerance);
    const Pose far{{0, 0, 0, 0, 0, 3.5}};  // further than half a turn: shorter the other way
    EXPECT_NEAR(interpolated(kIdentity, far, 0.5).value[5], (3.5 - 2.0 * pi) / 2.0, kTolerance);
}

TEST(UrscriptPoseMath, SmallTurnsAreNotLost) {
    constexpr double kSmall = 1e-12;
    const Pose turn{{0, 0, 0, kSmall, 0, 0}};
    EXPECT_NEAR(transformed(turn, turn).value[3], 2.0 * kSmall, 1e-3 * kSmall);
    EXPECT_NEAR(inverted(turn).value[3], -kSmall, 1e-3 * kSmall);
}

TEST(UrscriptPoseMath, RollPitchYawTurnAboutTheFixedAxesInThatOrder) {
    const Vector3 turn = rotationVectorOf({pi / 2.0, 0.0, pi / 2.0});
    const Pose rotation{{0, 0, 0, turn[0], turn[1], turn[2]}};
    const Pose y_axis = transformed(rotation, Pose{{0, 1, 0, 0, 0, 0}});
    EXPECT_NEAR(y_axis.value[2], 1.0, kTolerance);  // x turns y into z; z leaves that alone
    const Pose z_axis = transformed(rotation, Pose{{0, 0, 1, 0, 0, 0}});
    EXPECT_NEAR(z_axis.value[0], 1.0, kTolerance);  // x turns z into -y, and z that into x
}

TEST(UrscriptPoseMath, RollPitchYawAndRotationVectorsAreTheSameRotation) {
    RandomPoses poses;
    for (int i = 0; i < 200; ++i) {
        const Pose pose = poses.next();
        const Vector3 vector{pose.value[3], pose.value[4], pose.value[5]};
        const Vector3 again = rotationVectorOf(rollPitchYawOf(vector));
        expectSame(Pose{{0, 0, 0, again[0], again[1], again[2]}},
                   Pose{{0, 0, 0, vector[0], vector[1], vector[2]}});
    }
    const Vector3 upright = rollPitchYawOf(rotationVectorOf({0.3, pi / 2.0, 0.0}));
    EXPECT_NEAR(upright[1], pi / 2.0, 1e-6);  // where roll and yaw are the same turn
}

}  // namespace
}  // namespace metier::urscript
