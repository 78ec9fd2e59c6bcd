#include "metier/motion/kinematics.hpp"

#include <gmock/gmock.h>

#include <random>

#include "kdl_oracle.hpp"
#include "kinematics_vectors.hpp"
#include "metier/motion/rotation.hpp"
#include "test_robots.hpp"

namespace metier::motion {
namespace {

using testing::HasSubstr;

/// The figures of docs/motion.md are for this many poses an arm.
const int kPoses = scaled(100000);

TEST(KinematicsVectors, ForwardAgreesWithEveryReferenceVector) {
    for (const KinematicsVector& vector : kKinematicsVectors) {
        const RobotModel model = loadRobot(std::string(vector.robot));
        const auto& [w, x, y, z] = vector.quaternion_wxyz;
        const motion::Pose expected{Eigen::Vector3d(vector.position.data()),
                                    Eigen::Quaterniond(w, x, y, z)};
        EXPECT_LT(poseError(model.kinematics().forward(vector.q), expected), 1e-11) << vector.robot;
    }
}

using KinematicsOf = EachRobot;
INSTANTIATE_TEST_SUITE_P(Robots, KinematicsOf, testing::ValuesIn(kRobots), robotName);

TEST_P(KinematicsOf, ForwardAndJacobianAgreeWithKdl) {
    KdlOracle oracle(model_.chain());
    std::mt19937_64 random(1);
    double worst_pose = 0;
    double worst_jacobian = 0;
    for (int i = 0; i < kPoses; ++i) {
        const JointVector q = randomPosition(model_, random);
        worst_pose = std::max(worst_pose, poseError(kinematics_.forward(q), oracle.forward(q)));
        worst_jacobian = std::max(
            worst_jacobian, (kinematics_.jacobian(q) - oracle.jacobian(q)).cwiseAbs().maxCoeff());
    }
    EXPECT_LT(worst_pose, 1e-12);
    EXPECT_LT(worst_jacobian, 1e-12);
}

TEST_P(KinematicsOf, LinkFramesFollowTheDescribedChain) {
    std::mt19937_64 random(2);
    const JointVector q = randomPosition(model_, random);
    const auto frames = kinematics_.forwardAll(q);
    motion::Pose frame;
    for (std::size_t i = 0; i < model_.axisCount(); ++i) {
        const JointDescription& joint = model_.chain().joints[i];
        frame = frame * joint.parent_from_joint *
                motion::Pose{{0, 0, 0}, Eigen::Quaterniond(Eigen::AngleAxisd(q[i], joint.axis))};
        EXPECT_LT(poseError(frames[i], frame), 1e-12);
    }
    EXPECT_LT(poseError(frames[model_.axisCount()], kinematics_.forward(q)), 1e-12);
}

TEST_P(KinematicsOf, HasAClosedForm) {
    EXPECT_NE(kinematics_.ikKind(), IkKind::numeric);
}

TEST_P(KinematicsOf, EverySolutionReachesThePoseAndOneIsTheOriginalPosition) {
    std::mt19937_64 random(3);
    double worst = 0;
    int without_original = 0;
    for (int i = 0; i < kPoses; ++i) {
        const JointVector q = randomPosition(model_, random);
        const motion::Pose pose = kinematics_.forward(q);
        const JointSolutions solutions =
            kinematics_.allSolutions(pose, model_.home(), kinematics_.redundancyAngle(q));
        double nearest = 10;
        for (const JointVector& solution : solutions) {
            worst = std::max(worst, poseError(kinematics_.forward(solution), pose));
            nearest = std::min(nearest, maxDifference(solution, q));
        }
        // If axes align, a rounding error of the pose moves them by its square root.
        without_original += nearest > 1e-4 ? 1 : 0;
    }
    EXPECT_LT(worst, 1e-10);
    EXPECT_EQ(without_original, 0);
}

TEST_P(KinematicsOf, InverseFindsAPositionInsideTheLimitsForEveryReachablePose) {
    std::mt19937_64 random(4);
    for (int i = 0; i < kPoses; ++i) {
        const motion::Pose pose = kinematics_.forward(randomPosition(model_, random));
        const auto q = kinematics_.inverse(pose, {randomPosition(model_, random), {}, {}});
        ASSERT_TRUE(q) << i << ": " << q.error().message;
        ASSERT_LT(poseError(kinematics_.forward(*q), pose), 1e-10);
        ASSERT_TRUE(kinematics_.withinLimits(*q));
    }
}

/// Time in which an axis gets from `reference` to an angle, or to the same angle some turns away,
/// whichever is nearest within its limits [s]; 1e9 if none is.
double leastTurnTime(const JointLimits& limits, double angle, double reference) {
    double least = 1e9;
    for (int turn = -2; turn <= 2; ++turn) {
        const double turned = angle + turn * 2 * std::numbers::pi;
        if (turned >= limits.lower && turned <= limits.upper) {
            least = std::min(least, std::abs(turned - reference) / limits.velocity);
        }
    }
    return least;
}

TEST_P(KinematicsOf, InverseGivesTheNearestOfAllSolutionsAndTurns) {
    std::mt19937_64 random(5);
    for (int i = 0; i < scaled(10000); ++i) {
        const motion::Pose pose = kinematics_.forward(randomPosition(model_, random));
        const JointVector reference = randomPosition(model_, random);
        double least = 1e9;
        for (const JointVector& solution : kinematics_.allSolutions(pose, reference)) {
            double cost = 0;
            for (std::size_t axis = 0; axis < solution.size(); ++axis) {
                cost = std::max(
                    cost, leastTurnTime(model_.limits(axis), solution[axis], reference[axis]));
            }
            least = std::min(least, cost);
        }
        const auto chosen = kinematics_.inverse(pose, {reference, {}, {}});
        ASSERT_TRUE(chosen);
        double cost = 0;
        for (std::size_t axis = 0; axis < chosen->size(); ++axis) {
            cost = std::max(
                cost, std::abs((*chosen)[axis] - reference[axis]) / model_.limits(axis).velocity);
        }
        if (least < 1e9) {
            ASSERT_NEAR(cost, least, 1e-9);
        }
    }
}

TEST_P(KinematicsOf, LevenbergMarquardtReachesThePoseFromNearby) {
    std::mt19937_64 random(6);
    std::uniform_real_distribution<double> near(-0.1, 0.1);
    int missed = 0;
    for (int i = 0; i < kPoses; ++i) {
        const JointVector q = randomPosition(model_, random);
        const motion::Pose pose = kinematics_.forward(q);
        JointVector seed = q;
        for (double& angle : seed) {
            angle += near(random);
        }
        const auto solution = kinematics_.solveNumerically(pose, seed, 200);
        missed += solution ? 0 : 1;
        ASSERT_LT(solution ? poseError(kinematics_.forward(*solution), pose) : 0.0, 1e-8);
    }
    EXPECT_LE(missed, kPoses / 10000);  // beside a singularity only another seed helps
}

TEST_P(KinematicsOf, LevenbergMarquardtWithOtherSeedsSolvesEveryReachablePose) {
    std::mt19937_64 random(9);
    for (int i = 0; i < kPoses; ++i) {
        const motion::Pose pose = kinematics_.forward(randomPosition(model_, random));
        const auto q =
            kinematics_.inverseNumerically(pose, {randomPosition(model_, random), {}, {}});
        ASSERT_TRUE(q) << i << ": " << q.error().message;
        ASSERT_LT(poseError(kinematics_.forward(*q), pose), 1e-8);
        ASSERT_TRUE(kinematics_.withinLimits(*q));
    }
}

TEST_P(KinematicsOf, InverseGivesTheSameBitsEveryTime) {
    std::mt19937_64 random(7);
    const motion::Pose pose = kinematics_.forward(randomPosition(model_, random));
    const auto first = kinematics_.inverse(pose, {model_.home(), {}, {}});
    for (int i = 0; i < 100; ++i) {
        EXPECT_EQ(*kinematics_.inverse(pose, {model_.home(), {}, {}}), *first);
    }
}

TEST_P(KinematicsOf, InverseRefusesAPoseOutOfReachWithDistanceAndReach) {
    const motion::Pose far{{5, 0, 0}, Eigen::Quaterniond::Identity()};
    const auto refused = kinematics_.inverse(far, {model_.home(), {}, {}});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::unreachable);
    EXPECT_THAT(refused.error().message, HasSubstr("reach"));
    EXPECT_THAT(refused.error().message, HasSubstr("m from axis 2"));
}

TEST_P(KinematicsOf, InverseKeepsToTheAxisBounds) {
    const motion::Pose pose = kinematics_.forward(model_.home());
    AxisBounds bounds{model_.home(), model_.home()};
    for (std::size_t i = 0; i < model_.axisCount(); ++i) {
        bounds.lower[i] -= 0.01;
        bounds.upper[i] += 0.01;
    }
    const JointVector elsewhere = JointVector::constant(model_.axisCount(), 0.5);
    const double arm_angle = kinematics_.redundancyAngle(model_.home());
    const auto inside = kinematics_.inverse(pose, {elsewhere, bounds, arm_angle});
    ASSERT_TRUE(inside) << inside.error().message;
    EXPECT_LT(maxDifference(*inside, model_.home()), 1e-9);

    bounds.lower[1] += 0.05;
    bounds.upper[1] += 0.05;
    const auto refused = kinematics_.inverse(pose, {elsewhere, bounds, arm_angle});
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr("limit"));
}

TEST_P(KinematicsOf, TheHomePositionIsFarFromASingularity) {
    EXPECT_GT(kinematics_.smallestSingularValue(model_.home()), 0.05);
    EXPECT_LT(kinematics_.smallestSingularValue(JointVector(model_.axisCount())), 1e-9);
}

TEST(Kinematics, InverseRefusesWrongSizesAndWhatIsNotFinite) {
    const RobotModel model = loadRobot("ur5");
    const motion::Pose pose = model.kinematics().forward(model.home());
    EXPECT_EQ(model.kinematics().inverse(pose, {JointVector(7), {}, {}}).error().code,
              Errc::invalid_argument);
    JointVector nan = model.home();
    nan[2] = std::nan("");
    EXPECT_EQ(model.kinematics().inverse(pose, {nan, {}, {}}).error().code, Errc::invalid_argument);
    const auto turned = model.kinematics().inverse(pose, {model.home(), {}, std::nan("")});
    ASSERT_FALSE(turned);
    EXPECT_EQ(turned.error().code, Errc::invalid_argument);
}

/// The iiwa with its wrist pulled apart: no closed form fits.
RobotModel offsetWristArm() {
    ChainDescription chain = loadRobot("iiwa7").chain();
    chain.joints[5].parent_from_joint.translation += Eigen::Vector3d(0.05, 0.0, 0.0);
    chain.joints[6].parent_from_joint.translation += Eigen::Vector3d(0.03, 0.02, 0.0);
    return RobotModel::fromChain(chain).value();
}

TEST(Kinematics, ReachesAllRoundAnArmWhoseSecondAxisIsBesideItsFirst) {
    ChainDescription chain = loadRobot("edo").chain();
    chain.joints[1].parent_from_joint.translation.x() = 0.3;
    chain.joints[4].parent_from_joint.translation.y() = 0.05;
    const RobotModel model = RobotModel::fromChain(chain).value();
    const Kinematics& arm = model.kinematics();
    ASSERT_EQ(arm.ikKind(), IkKind::numeric);
    std::mt19937_64 random(9);
    for (int i = 0; i < 300; ++i) {
        const Pose pose = arm.forward(randomPosition(model, random));
        EXPECT_FALSE(arm.outOfReach(pose, model.home()));
        const auto solution = arm.inverse(pose, {model.home(), {}, {}});
        ASSERT_TRUE(solution) << solution.error().message;
    }
    // The other way round the base, as far as axis 2 and the links allow.
    const Pose far{{-0.3 - arm.reach() - 0.01, 0, 0.337}, Eigen::Quaterniond::Identity()};
    const auto miss = arm.outOfReach(far, model.home());
    ASSERT_TRUE(miss);
    EXPECT_NEAR(miss->excess(), 0.01, 1e-9);
}

TEST(Kinematics, SolvesAnyOtherChainNumerically) {
    const RobotModel model = offsetWristArm();
    EXPECT_EQ(model.kinematics().ikKind(), IkKind::numeric);
    std::mt19937_64 random(8);
    for (int i = 0; i < 1000; ++i) {
        const motion::Pose pose = model.kinematics().forward(randomPosition(model, random));
        const auto q = model.kinematics().inverse(pose, {model.home(), {}, {}});
        ASSERT_TRUE(q) << i << ": " << q.error().message;
        ASSERT_LT(poseError(model.kinematics().forward(*q), pose), 1e-8);
        ASSERT_TRUE(model.kinematics().withinLimits(*q));
    }
}

}  // namespace
}  // namespace metier::motion
