#include "motions.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "metier/motion/rotation.hpp"
#include "robot_fixture.hpp"

namespace metier::virtual_ur {
namespace {

using testing::DoubleNear;
using testing::Pointwise;

constexpr double kStep = 0.008;

/// Runs a motion and remembers what it needed of the axes.
struct Drive {
    JointState now;
    double fastest = 0.0;
    double hardest = 0.0;
    std::size_t cycles = 0;

    bool step(Motion& motion) {
        const auto next = motion.next(now, kStep);
        if (!next) {
            return false;
        }
        for (std::size_t i = 0; i < kAxes; ++i) {
            const double velocity = ((*next)[i] - now.position[i]) / kStep;
            fastest = std::max(fastest, std::abs(velocity));
            hardest = std::max(hardest, std::abs(velocity - now.velocity[i]) / kStep);
            now.velocity[i] = velocity;
            now.position[i] = (*next)[i];
        }
        ++cycles;
        return true;
    }
    bool toEnd(Motion& motion, std::size_t most = 10'000) {
        do {
            if (!step(motion)) {
                return false;
            }
        } while (!motion.done() && cycles < most);
        return motion.done();
    }
};

const Vector6 kHome{0.0, -1.3, 1.75, -2.02, -1.57, 0.0};

Vector6 shifted(Vector6 q, double by) {
    for (auto& value : q) {
        value += by;
    }
    return q;
}

TEST(Motions, AMoveOfJointsArrivesWithinItsSpeeds) {
    Drive drive{{kHome, {}}};
    const auto motion = moveJ(kHome, shifted(kHome, 0.8), {1.0, 2.0, 0.0});
    ASSERT_TRUE(drive.toEnd(*motion));
    EXPECT_THAT(drive.now.position, Pointwise(DoubleNear(1e-9), shifted(kHome, 0.8)));
    EXPECT_NEAR(static_cast<double>(drive.cycles) * kStep, 0.8 / 1.0 + 1.0 / 2.0, 0.02);
    EXPECT_LE(drive.fastest, 1.0 + 1e-6);
    EXPECT_LE(drive.hardest, 2.0 * 1.05);
}

TEST(Motions, AMoveWithATimeTakesThatTime) {
    Drive drive{{kHome, {}}};
    const auto motion = moveJ(kHome, shifted(kHome, 0.1), {1.0, 1.4, 2.0});
    ASSERT_TRUE(drive.toEnd(*motion));
    EXPECT_NEAR(static_cast<double>(drive.cycles) * kStep, 2.0, 0.01);
}

TEST(Motions, AMoveWithATimeNeedsNoSpeeds) {
    // Arguments of a client that gives a point by its time only: a = 0, v = 0, t = 1.
    for (const auto& [velocity, acceleration] :
         {std::pair{0.0, 0.0}, {0.0, 1.4}, {1.0, 0.0}, {0.01, 1.4}}) {
        Drive drive{{kHome, {}}};
        const auto motion = moveJ(kHome, shifted(kHome, 0.2), {velocity, acceleration, 1.0});
        ASSERT_TRUE(drive.toEnd(*motion));
        EXPECT_THAT(drive.now.position, Pointwise(DoubleNear(1e-9), shifted(kHome, 0.2)));
        EXPECT_LE(drive.fastest, 2.0 * 0.2);
        EXPECT_LE(drive.hardest, 6.0 * 0.2);
        EXPECT_NEAR(static_cast<double>(drive.cycles) * kStep, 1.0, 0.01);
    }
}

TEST(Motions, AMoveToWhereTheArmIsIsDoneAtOnce) {
    Drive drive{{kHome, {}}};
    ASSERT_TRUE(drive.toEnd(*moveJ(kHome, kHome, {1.0, 1.4, 0.0})));
    EXPECT_EQ(drive.cycles, 1U);
}

TEST(Motions, ALineIsStraight) {
    const auto model = modelOf("ur5");
    const ToolKinematics tool{model.kinematics(), toPose({0.0, 0.0, 0.1, 0.0, 0.0, 0.0})};
    const auto start = model.kinematics().forward(toJointVector(kHome)) * tool.flange_from_tool;
    auto target = start;
    target.translation += Eigen::Vector3d(0.0, 0.2, -0.1);
    Drive drive{{kHome, {}}};
    const auto motion = moveL(kHome, target, {0.25, 1.2, 0.0}, tool);
    double farthest = 0.0;
    const Eigen::Vector3d along = (target.translation - start.translation).normalized();
    while (!motion->done()) {
        ASSERT_TRUE(drive.step(*motion));
        const auto pose =
            model.kinematics().forward(toJointVector(drive.now.position)) * tool.flange_from_tool;
        farthest = std::max(farthest, (pose.translation - start.translation).cross(along).norm());
    }
    EXPECT_LT(farthest, 1e-9);
    EXPECT_NEAR(static_cast<double>(drive.cycles) * kStep, 0.2236 / 0.25 + 0.25 / 1.2, 0.02);
}

TEST(Motions, ALineThatNoAxesCanFollowGivesNoSetPoint) {
    const auto model = modelOf("ur5");
    const ToolKinematics tool{model.kinematics(), {}};
    auto target = model.kinematics().forward(toJointVector(kHome));
    target.translation += Eigen::Vector3d(0.0, 0.0, 2.0);
    Drive drive{{kHome, {}}};
    const auto motion = moveL(kHome, target, {0.25, 1.2, 0.0}, tool);
    EXPECT_FALSE(drive.toEnd(*motion));
}

TEST(Motions, ASpeedIsReachedWithTheAccelerationAndKept) {
    Drive drive{{kHome, {}}};
    const auto motion = speedJ({0.5, 0.0, 0.0, 0.0, 0.0, -0.25}, 1.0, 0.0);
    ASSERT_TRUE(drive.toEnd(*motion));
    EXPECT_NEAR(static_cast<double>(drive.cycles) * kStep, 0.5, 0.01);
    drive.step(*motion);
    EXPECT_THAT(drive.now.velocity,
                Pointwise(DoubleNear(1e-9), Vector6{0.5, 0.0, 0.0, 0.0, 0.0, -0.25}));
    EXPECT_LE(drive.hardest, 1.0 + 1e-6);
}

TEST(Motions, AToolSpeedMovesTheToolThatWay) {
    const auto model = modelOf("ur5");
    const ToolKinematics tool{model.kinematics(), toPose({0.05, 0.0, 0.1, 0.0, 0.0, 0.0})};
    const auto poseOf = [&](const Vector6& q) {
        return model.kinematics().forward(toJointVector(q)) * tool.flange_from_tool;
    };
    Drive drive{{kHome, {}}};
    const auto motion = speedL({0.0, 0.0, 0.1, 0.0, 0.0, 0.2}, 1.0, 0.5, tool);
    ASSERT_TRUE(drive.toEnd(*motion));
    const auto before = poseOf(drive.now.position);
    drive.step(*motion);
    const auto after = poseOf(drive.now.position);
    EXPECT_NEAR((after.translation.z() - before.translation.z()) / kStep, 0.1, 1e-4);
    EXPECT_NEAR((after.translation.x() - before.translation.x()) / kStep, 0.0, 1e-4);
    EXPECT_NEAR(static_cast<double>(drive.cycles) * kStep, 0.5, 0.02);
}

TEST(Motions, ATwistThatIsAskedForAtOnceStaysWithinWhatTheJointsCanDo) {
    const auto model = modelOf("ur5");
    Drive drive{{kHome, {}}};
    const auto motion = speedL({0.5, 0.0, 0.0, 0.0, 0.0, 0.0}, 40.0, 0.2, {model.kinematics(), {}});
    ASSERT_TRUE(drive.toEnd(*motion));
    EXPECT_LE(drive.hardest, 20.0 + 1e-6);
}

TEST(Motions, AStopBrakesAllAxesTogether) {
    Drive drive{{kHome, {1.0, -0.5, 0.0, 0.0, 0.0, 0.0}}};
    const auto motion = stopJ(2.0);
    ASSERT_TRUE(drive.toEnd(*motion));
    EXPECT_EQ(drive.now.velocity, Vector6{});
    EXPECT_NEAR(static_cast<double>(drive.cycles) * kStep, 0.5, 0.01);
    EXPECT_NEAR(drive.now.position[0] - kHome[0], 0.25, 0.01);
    EXPECT_NEAR(drive.now.position[1] - kHome[1], -0.125, 0.01);
}

TEST(Motions, AServoLagsBehindAMovingSetPointByLookaheadAndGain) {
    ServoMotion motion({kHome, {}});
    Drive drive{{kHome, {}}};
    constexpr double kLag = 0.1 + 1.0 / 300.0;
    Vector6 target = kHome;
    for (int i = 0; i < 400; ++i) {
        target[0] += 0.2 * kStep;
        motion.retarget(target, kStep, kLag);
        ASSERT_TRUE(drive.step(motion));
        EXPECT_TRUE(motion.done());
    }
    EXPECT_NEAR(drive.now.velocity[0], 0.2, 1e-6);
    EXPECT_NEAR((target[0] - drive.now.position[0]) / 0.2, kLag, kStep);
}

TEST(Motions, AServoArrivesAtASetPointThatStands) {
    ServoMotion motion({kHome, {}});
    Drive drive{{kHome, {}}};
    motion.retarget(shifted(kHome, 0.01), kStep, 0.03 + 1.0 / 2000.0);
    for (int i = 0; i < 100; ++i) {
        drive.step(motion);
    }
    EXPECT_EQ(drive.now.position, shifted(kHome, 0.01));
    EXPECT_EQ(drive.now.velocity, Vector6{});
}

TEST(Motions, ALineServoArrivesWithinItsSpeedsAndRests) {
    const auto model = modelOf("ur5");
    const ToolKinematics tool{model.kinematics(), toPose({0.05, 0.0, 0.1, 0.0, 0.0, 0.0})};
    const auto poseOf = [&](const Vector6& q) {
        return model.kinematics().forward(toJointVector(q)) * tool.flange_from_tool;
    };
    const auto start = poseOf(kHome);
    auto target = start;
    target.translation += Eigen::Vector3d(0.0, 0.1, -0.05);
    target.rotation = toPose({0.0, 0.0, 0.0, 0.0, 0.0, 0.4}).rotation * target.rotation;
    LineServo motion({kHome, {}});
    Drive drive{{kHome, {}}};
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
    int cycles = 0;
    do {
        motion.retarget(target, {0.2, 1.0, 0.0}, tool);
        const auto before = poseOf(drive.now.position);
        ASSERT_TRUE(drive.step(motion));
        EXPECT_TRUE(motion.done());
        const Eigen::Vector3d after =
            (poseOf(drive.now.position).translation - before.translation) / kStep;
        EXPECT_LE(after.norm(), 0.2 + 1e-6);
        EXPECT_LE((after - velocity).norm() / kStep, 1.0 + 1e-3);
        velocity = after;
    } while (drive.now.velocity != Vector6{} && ++cycles < 1000);
    EXPECT_LT(motion::distanceBetween(poseOf(drive.now.position), target), 1e-8);
    EXPECT_LT(motion::rotationAngleBetween(poseOf(drive.now.position).rotation, target.rotation),
              1e-7);
    // 0.119 m, the turn counted as 0.04 m across it.
    EXPECT_NEAR(cycles * kStep, 0.1188 / 0.2 + 0.2 / 1.0, 0.03);
}

TEST(Motions, ALineServoTakesOverFromAMovingArmWithoutAJump) {
    const auto model = modelOf("ur5");
    const ToolKinematics tool{model.kinematics(), {}};
    const Vector6 moving{0.3, 0.0, 0.0, 0.0, 0.0, 0.0};
    auto target = model.kinematics().forward(toJointVector(kHome));
    target.translation += Eigen::Vector3d(0.1, 0.0, 0.0);
    LineServo motion({kHome, moving});
    Drive drive{{kHome, moving}};
    motion.retarget(target, {0.25, 1.2, 0.0}, tool);
    do {
        ASSERT_TRUE(drive.step(motion));
    } while (drive.now.velocity != Vector6{} && drive.cycles < 1000);
    EXPECT_LT(drive.cycles, 1000U);
    EXPECT_LT(drive.hardest, 10.0);
    EXPECT_LT(motion::distanceBetween(model.kinematics().forward(toJointVector(drive.now.position)),
                                      target),
              1e-8);
}

TEST(Motions, ALineServoOutOfReachGivesNoSetPoint) {
    const auto model = modelOf("ur5");
    auto target = model.kinematics().forward(toJointVector(kHome));
    target.translation += Eigen::Vector3d(0.0, 0.0, 2.0);
    LineServo motion({kHome, {}});
    Drive drive{{kHome, {}}};
    motion.retarget(target, {0.25, 1.2, 0.0}, {model.kinematics(), {}});
    bool followed = true;
    while (followed && drive.cycles < 2000) {
        followed = drive.step(motion);
    }
    EXPECT_FALSE(followed);
}

TEST(Motions, AServoTakesOverFromAMovingArmWithoutAJump) {
    const Vector6 moving{0.5, 0.0, 0.0, 0.0, 0.0, 0.0};
    ServoMotion motion({kHome, moving});
    Drive drive{{kHome, moving}};
    Vector6 target = kHome;
    target[0] += 0.05;  // position one lag later
    for (int i = 0; i < 50; ++i) {
        target[0] += 0.5 * kStep;
        motion.retarget(target, kStep, 0.1);
        drive.step(motion);
    }
    EXPECT_LT(drive.hardest, 4.0);
}

}  // namespace
}  // namespace metier::virtual_ur
