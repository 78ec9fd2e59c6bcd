// UR arms whose DH parameters were measured: axes that are only nearly parallel and meet only
// nearly.

#include <gmock/gmock.h>

#include <random>

#include "kdl_oracle.hpp"
#include "metier/motion/planner.hpp"
#include "test_robots.hpp"

namespace metier::motion {
namespace {

using motion::Pose;

Pose turnAbout(const Eigen::Vector3d& axis, double angle) {
    return {Eigen::Vector3d::Zero(), Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis))};
}

/// The nominal arm with every DH parameter off by up to 2 mm or 3 mrad.
RobotModel calibrated(const std::string& robot, std::mt19937_64& random) {
    std::uniform_real_distribution<double> length(-2e-3, 2e-3);
    std::uniform_real_distribution<double> angle(-3e-3, 3e-3);
    ChainDescription chain = loadRobot(robot).chain();
    const auto perturb = [&](Pose nominal) {
        // d and a before, alpha after the row's own, then the next joint's theta.
        nominal.translation.z() += length(random);
        nominal.translation.x() += length(random);
        return nominal * turnAbout(Eigen::Vector3d::UnitX(), angle(random)) *
               turnAbout(Eigen::Vector3d::UnitZ(), angle(random));
    };
    for (JointDescription& joint : chain.joints) {
        joint.parent_from_joint = perturb(joint.parent_from_joint);
    }
    chain.last_from_flange = perturb(chain.last_from_flange);
    return RobotModel::fromChain(chain).value();
}

double turnsApart(const JointVector& a, const JointVector& b) {
    double farthest = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        farthest = std::max(farthest, std::abs(std::remainder(a[i] - b[i], 2 * std::numbers::pi)));
    }
    return farthest;
}

class CalibratedArmOf : public testing::TestWithParam<std::string> {
protected:
    std::mt19937_64 random_{11};
};
INSTANTIATE_TEST_SUITE_P(Robots, CalibratedArmOf, testing::Values("ur5", "ur5e"), robotName);

TEST_P(CalibratedArmOf, IsRecognised) {
    EXPECT_FALSE(loadRobot(GetParam()).kinematics().isCalibrated());
    for (int i = 0; i < 100; ++i) {
        const RobotModel model = calibrated(GetParam(), random_);
        EXPECT_TRUE(model.kinematics().isCalibrated());
        EXPECT_EQ(model.kinematics().ikKind(), IkKind::three_parallel_axes);
        EXPECT_NEAR(model.kinematics().reach(), 1.1, 0.4);
    }
}

TEST_P(CalibratedArmOf, FindsAllSolutionsOfEveryPoseWithin1e8) {
    const RobotModel nominal = loadRobot(GetParam());
    double worst = 0;
    std::size_t found = 0;
    std::size_t expected = 0;
    int without_original = 0;
    for (int arm = 0; arm < 20; ++arm) {
        const RobotModel model = calibrated(GetParam(), random_);
        const Kinematics& kinematics = model.kinematics();
        KdlOracle oracle(model.chain());
        for (int i = 0; i < scaled(500); ++i) {
            const JointVector q = randomPosition(model, random_);
            const Pose pose = oracle.forward(q);
            const JointSolutions solutions = kinematics.allSolutions(pose, model.home());
            double nearest = 10;
            for (const JointVector& solution : solutions) {
                worst = std::max(worst, poseError(oracle.forward(solution), pose));
                nearest = std::min(nearest, turnsApart(solution, q));
            }
            without_original += nearest > 1e-4 ? 1 : 0;
            found += solutions.size();
            expected += nominal.kinematics().allSolutions(pose, model.home()).size();
        }
    }
    EXPECT_LT(worst, 1e-8);
    // If two solutions meet, the nominal arm may have none although the calibrated one has, or the
    // other way round.
    EXPECT_LE(without_original, 20 * scaled(500) / 100);
    EXPECT_NEAR(static_cast<double>(found) / static_cast<double>(expected), 1.0, 0.02);
}

TEST_P(CalibratedArmOf, HasEightDifferentSolutionsWhereTheNominalArmHas) {
    const RobotModel nominal = loadRobot(GetParam());
    const RobotModel model = calibrated(GetParam(), random_);
    const Pose pose = model.kinematics().forward(model.home());
    ASSERT_EQ(nominal.kinematics().allSolutions(pose, model.home()).size(), 8U);
    const JointSolutions solutions = model.kinematics().allSolutions(pose, model.home());
    ASSERT_EQ(solutions.size(), 8U);
    for (std::size_t i = 0; i < 8; ++i) {
        EXPECT_LT(poseError(model.kinematics().forward(solutions[i]), pose), 1e-8);
        for (std::size_t k = 0; k < i; ++k) {
            EXPECT_GT(turnsApart(solutions[i], solutions[k]), 0.01);
        }
    }
}

TEST_P(CalibratedArmOf, ReachesEveryReachablePose) {
    for (int arm = 0; arm < 5; ++arm) {
        const RobotModel model = calibrated(GetParam(), random_);
        for (int i = 0; i < scaled(400); ++i) {
            const Pose pose = model.kinematics().forward(randomPosition(model, random_));
            const auto q = model.kinematics().inverse(pose, {model.home(), {}, {}});
            ASSERT_TRUE(q) << q.error().message;
            ASSERT_LT(poseError(model.kinematics().forward(*q), pose), 1e-8);
        }
    }
}

TEST_P(CalibratedArmOf, RunsALineOnTheLine) {
    const RobotModel model = calibrated(GetParam(), random_);
    LinRequest request;
    request.start = model.home();
    request.reference = TargetReference::relative_base;
    request.target.translation = {0.05, 0.1, -0.1};
    const auto plan = Planner(model).lin(request);
    ASSERT_TRUE(plan) << plan.error().error.message;
    for (double t = 0; t < plan->duration().count(); t += model.cycleTime()) {
        const Pose pose = plan->toolPose(plan->sample(Seconds(t)).position);
        ASSERT_LE(plan->deviation(pose).distance, 1e-9);
        ASSERT_LE(plan->deviation(pose).angle, 1e-7);
    }
}

TEST_P(CalibratedArmOf, SaysThatATargetIsOutOfReach) {
    const RobotModel model = calibrated(GetParam(), random_);
    LinRequest request;
    request.start = model.home();
    request.reference = TargetReference::relative_base;
    request.target.translation = {1.5, 0, 0};
    const auto plan = Planner(model).lin(request);
    ASSERT_FALSE(plan);
    EXPECT_EQ(plan.error().reason, RefusalReason::unreachable);
    EXPECT_THAT(plan.error().error.message, testing::HasSubstr("the wrist would be"));
}

TEST(CalibratedArm, AnArmOfAnotherStructureIsNotTakenForOne) {
    ChainDescription chain = loadRobot("ur5").chain();
    chain.joints[5].parent_from_joint.translation.y() += 0.05;
    chain.joints[5].parent_from_joint.translation.x() += 0.05;
    const RobotModel model = RobotModel::fromChain(chain).value();
    EXPECT_EQ(model.kinematics().ikKind(), IkKind::numeric);
    EXPECT_FALSE(model.kinematics().isCalibrated());
}

}  // namespace
}  // namespace metier::motion
