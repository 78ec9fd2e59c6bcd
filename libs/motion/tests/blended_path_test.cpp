#include <gmock/gmock.h>

#include <cmath>
#include <random>

#include "metier/motion/planner.hpp"
#include "metier/motion/rotation.hpp"
#include "test_robots.hpp"

namespace metier::motion {
namespace {

using motion::Pose;
using testing::HasSubstr;

constexpr double kRadius = 0.03;

/// Three sides of a vertical square and a turn of the tool, corners rounded.
PathRequest roundedSquare(const RobotModel& model) {
    PathRequest request;
    request.lin.start = model.home();
    request.lin.reference = TargetReference::relative_base;
    request.lin.max_velocity = {0.25, 0.25, 0.25, 1, 1, 1};
    request.lin.max_acceleration = {1.2, 1.2, 1.2, 4, 4, 4};
    const auto side = [](double y, double z, double turn) {
        return PathWaypoint{{{0, y, z}, motion::fromRotationVector({0, 0, turn})}, kRadius};
    };
    request.waypoints = {side(0.1, 0, 0.2), side(0, 0.1, -0.3), side(-0.1, 0, 0.1)};
    return request;
}

using BlendedPathOf = EachRobot;
INSTANTIATE_TEST_SUITE_P(Robots, BlendedPathOf, testing::ValuesIn(kRobots), robotName);

TEST_P(BlendedPathOf, StaysInTheSphereOfEveryCornerAndEndsAtTheLastPose) {
    const PathRequest request = roundedSquare(model_);
    const auto plan = Planner(model_).path(request);
    ASSERT_TRUE(plan) << plan.error().error.message;
    const Pose start = plan->toolPose(model_.home());
    std::vector<Eigen::Vector3d> corners{start.translation};
    for (const PathWaypoint& waypoint : request.waypoints) {
        corners.emplace_back(corners.back() + waypoint.target.translation);
    }
    for (int i = 0; i <= 500; ++i) {
        const Pose pose = plan->poseAt(i / 500.0);
        double off_lines = 1;
        for (std::size_t k = 0; k + 1 < corners.size(); ++k) {
            const Eigen::Vector3d side = corners[k + 1] - corners[k];
            const double u = std::clamp(
                (pose.translation - corners[k]).dot(side) / side.squaredNorm(), 0.0, 1.0);
            off_lines = std::min(off_lines, (pose.translation - corners[k] - u * side).norm());
        }
        double to_corner = 1;
        for (const Eigen::Vector3d& corner : corners) {
            to_corner = std::min(to_corner, (pose.translation - corner).norm());
        }
        ASSERT_TRUE(off_lines < 1e-12 || to_corner <= kRadius) << i;
    }
    EXPECT_LT((plan->endPose().translation - corners.back()).norm(), 1e-9);
    EXPECT_LT(poseError(plan->toolPose(plan->end()), plan->endPose()), 1e-9);
}

TEST_P(BlendedPathOf, HasNoJumpInVelocityOrAngularVelocityAndKeepsTheLimits) {
    const auto plan = Planner(model_).path(roundedSquare(model_));
    ASSERT_TRUE(plan) << plan.error().error.message;
    constexpr double cycle = 0.001;
    const CartesianLimits& own = model_.cartesianLimits();
    const double acceleration = std::min(1.2, own.acceleration);
    const double angular_acceleration = std::min(4.0, own.angular_acceleration);
    const auto pose = [&](double time) {
        return plan->toolPose(plan->sample(Seconds(time)).position);
    };
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
    Eigen::Vector3d spin = Eigen::Vector3d::Zero();
    Pose before = pose(-cycle);
    double slowest_inside = 1;
    for (double time = 0; time < plan->duration().count() + cycle; time += cycle) {
        const Pose now = pose(time);
        const Eigen::Vector3d v = (now.translation - before.translation) / cycle;
        const Eigen::Vector3d w =
            motion::rotationVectorBetween(before.rotation, now.rotation) / cycle;
        ASSERT_LE((v - velocity).norm() / cycle, 1.02 * acceleration) << time;
        ASSERT_LE((w - spin).norm() / cycle, 1.02 * angular_acceleration) << time;
        ASSERT_LE(v.norm(), 1.001 * std::min(0.25, own.velocity));
        const bool inside =
            time > 0.25 * plan->duration().count() && time < 0.75 * plan->duration().count();
        slowest_inside = inside ? std::min(slowest_inside, v.norm()) : slowest_inside;
        velocity = v;
        spin = w;
        before = now;
    }
    EXPECT_GT(slowest_inside, 0.005);
}

TEST(BlendedPath, IsQuickerThanStoppingAndKeepsHalfTheSpeedWhereTheLimitsAllow) {
    for (const std::string robot : {"ur5", "ur5e", "iiwa7", "iiwa14"}) {
        const RobotModel model = loadRobot(robot);
        PathRequest request = roundedSquare(model);
        request.lin.max_velocity = {0.08, 0.08, 0.08, 1, 1, 1};
        const auto plan = Planner(model).path(request);
        ASSERT_TRUE(plan) << plan.error().error.message;
        Seconds stopping{0};
        LinRequest line = request.lin;
        for (const PathWaypoint& waypoint : request.waypoints) {
            line.target = waypoint.target;
            const auto side = Planner(model).lin(line);
            ASSERT_TRUE(side) << side.error().error.message;
            stopping += side->duration();
            line.start = side->end();
        }
        EXPECT_LT(plan->duration(), stopping);
        for (double share = 0.2; share < 0.8; share += 0.005) {
            const auto place = [&](double seconds) {
                const Seconds time = share * plan->duration() + Seconds(seconds);
                return plan->toolPose(plan->sample(time).position).translation;
            };
            ASSERT_GE((place(1e-4) - place(-1e-4)).norm() / 2e-4, 0.04) << robot;
        }
    }
}

TEST_P(BlendedPathOf, OfOneWaypointIsALine) {
    PathRequest request = roundedSquare(model_);
    request.waypoints.resize(1);
    LinRequest line = request.lin;
    line.target = request.waypoints[0].target;
    const auto path = Planner(model_).path(request);
    const auto lin = Planner(model_).lin(line);
    ASSERT_TRUE(path && lin);
    EXPECT_NEAR(path->duration().count(), lin->duration().count(), 0.02 * lin->duration().count());
    EXPECT_LT(maxDifference(path->end(), lin->end()), 1e-9);
}

TEST(BlendedPath, RunsASlowerLegSlower) {
    const RobotModel model = loadRobot("iiwa7");
    PathRequest request = roundedSquare(model);
    const Seconds quick = Planner(model).path(request).value().duration();
    request.waypoints[1].max_velocity = 0.05;
    EXPECT_GT(Planner(model).path(request).value().duration(), quick + Seconds(0.5));
}

TEST(BlendedPath, RefusesAWaypointWithoutABlendRadius) {
    const RobotModel model = loadRobot("ur5");
    PathRequest request = roundedSquare(model);
    request.waypoints[0].blend_radius = 0;
    const auto plan = Planner(model).path(request);
    ASSERT_FALSE(plan);
    EXPECT_THAT(plan.error().error.message, HasSubstr("waypoint 1: blend radius 0 m"));
    request.waypoints[0].blend_radius = 0.9e-6;
    const auto tiny = Planner(model).path(request);
    ASSERT_FALSE(tiny);
    EXPECT_THAT(tiny.error().error.message,
                HasSubstr("blend radius 9e-07 m under 1e-06 m: no arm could show the corner"));
    request.waypoints[0].blend_radius = 1.1e-6;
    EXPECT_TRUE(Planner(model).path(request));
    request.waypoints.clear();
    EXPECT_FALSE(Planner(model).path(request));
}

TEST(BlendedPath, RefusesABlendRadiusOverHalfOfTheShorterLine) {
    const RobotModel model = loadRobot("ur5");
    PathRequest request = roundedSquare(model);
    request.waypoints[1].blend_radius = 0.06;
    const auto plan = Planner(model).path(request);
    ASSERT_FALSE(plan);
    EXPECT_EQ(plan.error().reason, RefusalReason::invalid_request);
    EXPECT_THAT(plan.error().error.message,
                HasSubstr("waypoint 2: blend radius 0.06 m over 0.0500 m"));
}

TEST(BlendedPath, TakesCornersThatMeetInTheMiddleOfALine) {
    const RobotModel model = loadRobot("ur5");
    PathRequest request = roundedSquare(model);
    request.waypoints[0].blend_radius = request.waypoints[1].blend_radius = 0.05;
    const auto plan = Planner(model).path(request);
    ASSERT_TRUE(plan) << plan.error().error.message;
    const Eigen::Vector3d start = plan->toolPose(model.home()).translation;
    const Eigen::Vector3d middle = start + Eigen::Vector3d(0, 0.1, 0.05);
    double nearest = 1;
    for (int i = 0; i <= 2000; ++i) {
        nearest = std::min(nearest, (plan->poseAt(i / 2000.0).translation - middle).norm());
    }
    EXPECT_LT(nearest, 1e-4) << "[m]";
}

TEST(BlendedPath, TellsWhichWaypointIsOutOfReach) {
    const RobotModel model = loadRobot("ur5");
    PathRequest request = roundedSquare(model);
    request.waypoints[1].target.translation.z() += 2.0;
    const auto plan = Planner(model).path(request);
    ASSERT_FALSE(plan);
    EXPECT_EQ(plan.error().reason, RefusalReason::unreachable);
    EXPECT_THAT(plan.error().error.message, testing::StartsWith("waypoint 2: unreachable: "));
}

TEST(BlendedPath, TellsTheWaypointThatAWayLeadsTo) {
    const RobotModel model = loadRobot("ur5");
    PathRequest request = roundedSquare(model);
    const auto axis = JointVector::from(std::vector<double>(6, 0.6)).value();
    request.lin.axis_bounds = {model.home(), model.home()};
    request.lin.axis_bounds.lower.view() -= axis.view();
    request.lin.axis_bounds.upper.view() += axis.view();
    request.waypoints[1].target.rotation = motion::fromRotationVector({0, 0, 0.8});
    const auto plan = Planner(model).path(request);
    ASSERT_FALSE(plan);
    EXPECT_EQ(plan.error().reason, RefusalReason::joint_limit);
    EXPECT_THAT(plan.error().error.message, testing::StartsWith("on the way to waypoint 2: axis "));
}

TEST(BlendedPath, WithOneSlowLineIsFiniteAndAsLongAsItSays) {
    const RobotModel model = loadRobot("ur5e");
    PathRequest request;
    request.lin.start = model.home();
    request.lin.reference = TargetReference::relative_base;
    motion::Pose aside;
    aside.translation = {0, 0.2, 0};
    motion::Pose down;
    down.translation = {0, 0, -0.05};
    request.waypoints = {{.target = aside, .blend_radius = 0.02, .max_velocity = 0.25},
                         {.target = down, .blend_radius = 0, .max_velocity = 0.001}};
    const auto plan = Planner(model).path(request);
    ASSERT_TRUE(plan) << plan.error().error.message;
    ASSERT_TRUE(std::isfinite(plan->duration().count()));
    JointVector before = plan->start();
    for (int i = 1; i <= 20000; ++i) {
        const SetPoint point = plan->sample(i / 20000.0 * plan->duration());
        for (std::size_t axis = 0; axis < model.axisCount(); ++axis) {
            ASSERT_TRUE(std::isfinite(point.position[axis])) << "sample " << i;
        }
        ASSERT_LE(maxDifference(point.position, before), 0.01) << "sample " << i;
        before = point.position;
    }
    EXPECT_LE(maxDifference(before, plan->end()), 1e-9);
}

// Where the clock of a plan begins to stop, its acceleration has a peak: here 1.043 of the limit,
// between the places at which the plan was checked.
TEST(BlendedPath, KeepsItsAccelerationAlsoWhereItsClockBeginsToStop) {
    const auto model = loadRobot("iiwa7");
    constexpr double acceleration = 0.0042662351161173095;
    constexpr double radius = 1.001e-6;
    PathRequest request;
    request.lin.start = JointVector{0.36262699302789947, 0.5268124340485221,  0.22922540683123027,
                                    -1.4994290910304935, -0.1662219951277233, 1.4252860513862426,
                                    0.1720711387183198};
    request.lin.reference = TargetReference::relative_base;
    request.lin.max_acceleration = {acceleration, acceleration, acceleration, 0.01, 0.01, 0.01};
    const auto line = [](double x, double y, double z) {
        return PathWaypoint{{{x, y, z}, Eigen::Quaterniond::Identity()}, radius};
    };
    request.waypoints = {
        line(0.1885052036394676, -0.03326180187718767, -0.09754160550234743),
        line(0, 0, -0.019451430902331517), line(0, 0.0003219657403946937, 0),
        line(0.0003337162186053988, -0.00014689399799550526, -0.00017979037370414292)};
    const auto plan = Planner(model).path(request);
    ASSERT_TRUE(plan) << plan.error().error.message;
    constexpr double step = 1e-3;
    const auto place = [&](double time) {
        return plan->toolPose(plan->sample(Seconds(time)).position).translation;
    };
    double largest = 0;
    for (double time = step; time < plan->duration().count(); time += 2 * step) {
        const Eigen::Vector3d bend = place(time + step) - 2 * place(time) + place(time - step);
        largest = std::max(largest, bend.norm() / (step * step));
    }
    EXPECT_LE(largest, 1.01 * acceleration);
}

TEST(BlendedPath, RefusesTheSamePoseTwiceInARowButMayBeginWhereTheArmStands) {
    const RobotModel model = loadRobot("iiwa7");
    PathRequest request = roundedSquare(model);
    request.waypoints.insert(request.waypoints.begin(), PathWaypoint{{}, kRadius});
    const auto plan = Planner(model).path(request);
    ASSERT_TRUE(plan) << plan.error().error.message;
    const auto without = Planner(model).path(roundedSquare(model));
    EXPECT_NEAR(plan->duration().count(), without->duration().count(), 1e-9);
    request.waypoints.insert(request.waypoints.begin() + 2, PathWaypoint{{}, kRadius});
    const auto twice = Planner(model).path(request);
    ASSERT_FALSE(twice);
    EXPECT_THAT(twice.error().error.message,
                HasSubstr("waypoint 2: the next waypoint is the same"));
}

TEST_P(BlendedPathOf, FindsEachOfItsPlacesAgain) {
    const auto plan = Planner(model_).path(roundedSquare(model_));
    ASSERT_TRUE(plan) << plan.error().error.message;
    for (int i = 0; i <= 100; ++i) {
        ASSERT_LT(plan->deviation(plan->poseAt(i / 100.0)).distance, 1e-6) << i;
    }
}

TEST(BlendedPath, TheNearestPlaceOfOneOfItsOwnPosesIsThere) {
    const RobotModel model = loadRobot("ur5e");
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> side(-0.05, 0.05);
    int planned = 0;
    for (int n = 0; n < scaled(100); ++n) {
        PathRequest request;
        request.lin.start = model.home();
        request.lin.reference = TargetReference::relative_base;
        for (int i = 0; i < 3; ++i) {
            const Eigen::Vector3d line(side(random), side(random), side(random));
            request.waypoints.push_back({{line, Eigen::Quaterniond::Identity()}, line.norm()});
        }
        for (std::size_t i = 0; i < 2; ++i) {
            double& radius = request.waypoints[i].blend_radius;
            radius = 0.499 * std::min(radius, request.waypoints[i + 1].blend_radius);
        }
        const auto plan = Planner(model).path(request);
        planned += plan ? 1 : 0;
        for (int i = 0; plan && i <= 100; ++i) {
            ASSERT_LT(plan->deviation(plan->poseAt(i / 100.0)).distance, 1e-9)
                << "path " << n << ", place " << i;
        }
    }
    EXPECT_GT(planned, scaled(75));
}

}  // namespace
}  // namespace metier::motion
