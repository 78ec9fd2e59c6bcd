// Refusals of the planner, and their texts.

#include <gmock/gmock.h>

#include <chrono>
#include <random>

#include "metier/motion/planner.hpp"
#include "metier/motion/rotation.hpp"
#include "test_robots.hpp"

namespace metier::motion {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

LinRequest lineFromHome(const RobotModel& model, const Eigen::Vector3d& translation) {
    LinRequest request;
    request.start = model.home();
    request.reference = TargetReference::relative_base;
    request.target.translation = translation;
    return request;
}

using UnreachableOf = EachRobot;
INSTANTIATE_TEST_SUITE_P(Robots, UnreachableOf, testing::ValuesIn(kRobots), robotName);

TEST_P(UnreachableOf, ALineWhoseTargetIsOutOfReachSaysSoWithDistanceAndReach) {
    std::mt19937_64 random(1);
    std::normal_distribution<double> normal;
    for (int i = 0; i < scaled(200); ++i) {
        const Eigen::Vector3d direction =
            Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
        for (const double length : {1.9, 2.2, 4.0}) {
            const auto plan = Planner(model_).lin(lineFromHome(model_, length * direction));
            ASSERT_FALSE(plan);
            ASSERT_EQ(plan.error().reason, RefusalReason::unreachable)
                << plan.error().error.message;
            ASSERT_THAT(plan.error().error.message,
                        AllOf(HasSubstr("target: unreachable: the wrist would be"),
                              HasSubstr(" m from axis "), HasSubstr("reach"),
                              HasSubstr("% of the path"), Not(HasSubstr("singular"))));
            ASSERT_GT(plan.error().fraction, 0.0);
            ASSERT_LT(plan.error().fraction, 1.0);
            // Just before that place the arm does reach.
            const motion::Pose start = kinematics_.forward(model_.home());
            const double before = plan.error().fraction - 1e-4;
            const motion::Pose inside{start.translation + before * length * direction,
                                      start.rotation};
            ASSERT_FALSE(kinematics_.outOfReach(inside, model_.home()));
        }
    }
}

TEST_P(UnreachableOf, ATargetOnlyALittleOutOfReachIsUnreachableToo) {
    // Along a ray from home the first place out of reach, then a little farther.
    const motion::Pose home = kinematics_.forward(model_.home());
    double inside = 0;
    double outside = 3;
    const auto at = [&](double x) {
        return motion::Pose{home.translation + Eigen::Vector3d(x, 0, 0), home.rotation};
    };
    for (int i = 0; i < 50; ++i) {
        const double middle = (inside + outside) / 2;
        (kinematics_.outOfReach(at(middle), model_.home()) ? outside : inside) = middle;
    }
    for (const double beyond : {1e-4, 1e-3, 0.02}) {
        const auto plan = Planner(model_).lin(lineFromHome(model_, {outside + beyond, 0, 0}));
        ASSERT_FALSE(plan);
        EXPECT_EQ(plan.error().reason, RefusalReason::unreachable) << plan.error().error.message;
        PtpRequest ptp;
        ptp.start = model_.home();
        ptp.target = at(outside + beyond);
        const auto moved = Planner(model_).ptp(ptp);
        ASSERT_FALSE(moved);
        EXPECT_EQ(moved.error().reason, RefusalReason::unreachable);
        EXPECT_THAT(moved.error().error.message,
                    AllOf(HasSubstr("target: unreachable: the wrist would be"),
                          HasSubstr("m from axis 2, reach")));
    }
}

TEST_P(UnreachableOf, IsToldWithinAMillisecond) {
    std::chrono::nanoseconds least = std::chrono::seconds(1);
    for (int i = 0; i < 20; ++i) {
        const LinRequest request = lineFromHome(model_, {2.0, 0.01 * i, 0});
        const auto begin = std::chrono::steady_clock::now();
        const auto plan = Planner(model_).lin(request);
        least = std::min<std::chrono::nanoseconds>(least, std::chrono::steady_clock::now() - begin);
        ASSERT_FALSE(plan);
    }
    EXPECT_LT(least, std::chrono::milliseconds(1));
}

TEST(Unreachable, ALineWhoseWayIsOutOfReachSaysWhereAndHowFar) {
    // Through the arm's own column: both ends can be reached, the middle cannot.
    const RobotModel model = loadRobot("ur5");
    LinRequest request;
    request.start = model.home();
    JointVector there = model.home();
    there[0] += 3.0;
    request.target = model.kinematics().forward(there);
    request.target.rotation = model.kinematics().forward(model.home()).rotation;
    ASSERT_TRUE(model.kinematics().inverse(request.target, {there, {}, {}}));
    const auto plan = Planner(model).lin(request);
    ASSERT_FALSE(plan);
    EXPECT_EQ(plan.error().reason, RefusalReason::unreachable);
    EXPECT_THAT(plan.error().error.message,
                AllOf(HasSubstr("way: unreachable: the wrist would be"), HasSubstr("at least"),
                      HasSubstr("% of the path")));
    EXPECT_GT(plan.error().fraction, 0.1);
    EXPECT_LT(plan.error().fraction, 0.9);
}

/// A line that turns the wrist of an arm past axis 5 = 0, `beside` it [rad].
LinRequest pastTheWristSingularity(double beside) {
    LinRequest request;
    request.start = JointVector{0, 0.1, 1.2, 0, 0.3, 0};
    request.reference = TargetReference::relative_base;
    request.target.rotation = motion::fromRotationVector({0, -0.6, beside});
    return request;
}

TEST(Singular, APlaceNextToASingularityIsRefusedWithPlaceAxisValueAndLimit) {
    const RobotModel model = loadRobot("edo");
    const auto plan = Planner(model).lin(pastTheWristSingularity(0.02));
    ASSERT_FALSE(plan);
    EXPECT_EQ(plan.error().reason, RefusalReason::singularity);
    EXPECT_NEAR(plan.error().fraction, 0.28, 0.08);
    ASSERT_TRUE(plan.error().axis);
    EXPECT_TRUE(*plan.error().axis == 3 || *plan.error().axis == 5);
    EXPECT_THAT(plan.error().error.message,
                AllOf(HasSubstr("singularity: smallest singular value 0.00"),
                      HasSubstr("limit 0.01"), HasSubstr("% of the path")));
}

TEST(Singular, APlaceWhereAnAxisWouldJumpIsRefusedWithPlaceAndAxis) {
    const RobotModel model = loadRobot("edo");
    const auto plan = Planner(model).lin(pastTheWristSingularity(1e-4));
    ASSERT_FALSE(plan);
    EXPECT_EQ(plan.error().reason, RefusalReason::singularity);
    EXPECT_NEAR(plan.error().fraction, 0.28, 0.08);
    EXPECT_TRUE(plan.error().axis);
    EXPECT_THAT(plan.error().error.message,
                AllOf(HasSubstr("singularity: axis"), HasSubstr("in one place"),
                      HasSubstr("smallest singular value 0.0"), HasSubstr("% of the path")));
}

TEST(Singular, ALineThroughTheSingularityIsPlannedUnlessThatIsRefused) {
    const RobotModel model = loadRobot("edo");
    PlannerOptions options;
    EXPECT_TRUE(Planner(model, options).lin(pastTheWristSingularity(0)));
    options.singular_places = SingularPlaces::refused;
    const auto refused = Planner(model, options).lin(pastTheWristSingularity(0));
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().reason, RefusalReason::singularity);
    EXPECT_NEAR(refused.error().fraction, 0.28, 0.08);
}

TEST(Singular, TheLimitCanBeLoweredAndRaised) {
    const RobotModel model = loadRobot("edo");
    PlannerOptions options;
    const LinRequest beside = pastTheWristSingularity(0.03);
    options.smallest_singular_value = 0.002;
    options.slowest_share = 0;
    EXPECT_TRUE(Planner(model, options).lin(beside));
    options.smallest_singular_value = 0.1;
    EXPECT_FALSE(Planner(model, options).lin(beside));
    options.smallest_singular_value = 0;
    options.slowest_share = 0.9;  // the singular place makes it slower than that
    const auto slow = Planner(model, options).lin(beside);
    ASSERT_FALSE(slow);
    EXPECT_THAT(slow.error().error.message, HasSubstr("of the requested speed, limit 90.00 %"));
    EXPECT_TRUE(slow.error().axis);
}

TEST(Singular, APtpMayEndInASingularPlace) {
    const RobotModel model = loadRobot("edo");
    PtpRequest request;
    request.start = model.home();
    request.target = JointVector(6);
    EXPECT_TRUE(Planner(model).ptp(request));
}

TEST(RedundancyAngle, OfAnArmWithoutARedundantAxisIsIgnored) {
    for (const std::string robot : {"ur5", "edo"}) {
        const RobotModel model = loadRobot(robot);
        LinRequest line = lineFromHome(model, {0, 0, 0.05});
        const auto plain = Planner(model).lin(line);
        line.redundancy_angle = 0.7;
        const auto angled = Planner(model).lin(line);
        ASSERT_TRUE(plain && angled);
        EXPECT_EQ(plain->end(), angled->end());
        EXPECT_EQ(plain->duration(), angled->duration());
        PtpRequest ptp;
        ptp.start = model.home();
        ptp.target = plain->endPose();
        ptp.redundancy_angle = 0.7;
        const auto moved = Planner(model).ptp(ptp);
        ASSERT_TRUE(moved);
        EXPECT_LT(maxDifference(moved->end(), plain->end()), 1e-9);
    }
}

}  // namespace
}  // namespace metier::motion
