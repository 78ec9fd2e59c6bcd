// Rows of the acceptance table that look at whole moves; METIER_TEST_SCALE multiplies their number.

#include <gmock/gmock.h>

#include <chrono>
#include <cmath>
#include <cstring>
#include <random>
#include <stop_token>
#include <thread>

#include "kdl_oracle.hpp"
#include "metier/motion/motion_run.hpp"
#include "metier/motion/planner.hpp"
#include "metier/motion/rotation.hpp"
#include "test_robots.hpp"

namespace metier::motion {
namespace {

using motion::Pose;

LinRequest vertical(const RobotModel& model, double length) {
    LinRequest request;
    request.start = model.home();
    request.reference = TargetReference::relative_base;
    request.target.translation = {0, 0, length};
    request.max_velocity = {0.25, 0.25, 0.25, 1, 1, 1};
    request.max_acceleration = {1.2, 1.2, 1.2, 2, 2, 2};
    return request;
}

LinRequest randomLin(const RobotModel& model, std::mt19937_64& random) {
    std::uniform_real_distribution<double> unit(-1, 1);
    LinRequest request = vertical(model, 0);
    for (double& q : request.start) {
        q += 0.2 * unit(random);
    }
    request.target.translation = 0.15 * Eigen::Vector3d(unit(random), unit(random), unit(random));
    request.target.rotation =
        motion::fromRotationVector(0.4 * Eigen::Vector3d(unit(random), unit(random), unit(random)));
    return request;
}

/// Largest distance from the path of the joint line between two samples [m].
double farthestHalfWay(const Trajectory& plan, double cycle) {
    double worst = 0;
    for (double t = 0; t < plan.duration().count(); t += cycle) {
        JointVector middle = plan.sample(Seconds(t)).position;
        middle.view() = 0.5 * (middle.view() + plan.sample(Seconds(t + cycle)).position.view());
        worst = std::max(worst, plan.deviation(plan.toolPose(middle)).distance);
    }
    return worst;
}

using AcceptanceOf = EachRobot;
INSTANTIATE_TEST_SUITE_P(Robots, AcceptanceOf, testing::ValuesIn(kRobots), robotName);

TEST_P(AcceptanceOf, BetweenSamplesTheJointLineStaysNearTheLine) {
    const auto plan = Planner(model_).lin(vertical(model_, 0.08));
    ASSERT_TRUE(plan) << plan.error().error.message;
    EXPECT_LT(farthestHalfWay(*plan, 0.008), 5e-6);  // 0.005 mm at 0.25 m/s and 8 ms
}

TEST_P(AcceptanceOf, BetweenSamplesAQuickMotionStaysNearTheLineToo) {
    LinRequest request = vertical(model_, GetParam() == "edo" ? 0.08 : -0.12);
    request.max_velocity = {1, 1, 1, 3, 3, 3};
    request.max_acceleration = {};
    const auto plan = Planner(model_).lin(request);
    ASSERT_TRUE(plan) << plan.error().error.message;
    EXPECT_LT(farthestHalfWay(*plan, 0.008), 5e-5);  // 0.05 mm at up to 1 m/s and 8 ms
}

TEST_P(AcceptanceOf, TheSameMotionSampledAtTwoRatesAgrees) {
    const auto plan = Planner(model_).lin(vertical(model_, 0.08));
    ASSERT_TRUE(plan);
    MotionRun slow(*plan);
    MotionRun quick(*plan);
    while (!slow.finished()) {
        slow.next(Seconds(0.008));
        for (int i = 0; i < 8; ++i) {
            quick.next(Seconds(0.001));
        }
        ASSERT_LE(maxDifference(slow.current().position, quick.current().position), 1e-9);
    }
}

TEST_P(AcceptanceOf, AnUnreachableTargetIsRefusedWithinAMillisecond) {
    std::mt19937_64 random(1);
    const Pose far{{2.5, 0.3, 0.4}, Eigen::Quaterniond::Identity()};
    std::chrono::nanoseconds least = std::chrono::seconds(1);
    for (int i = 0; i < 20; ++i) {
        PtpRequest request;
        request.start = randomPosition(model_, random);
        request.target = far;
        const auto begin = std::chrono::steady_clock::now();
        const auto plan = Planner(model_).ptp(request);
        least = std::min<std::chrono::nanoseconds>(least, std::chrono::steady_clock::now() - begin);
        ASSERT_FALSE(plan);
        EXPECT_EQ(plan.error().reason, RefusalReason::unreachable);
    }
    EXPECT_LT(least, std::chrono::milliseconds(1));
}

TEST_P(AcceptanceOf, NoLineFlipsTheArmOnTheWay) {
    std::mt19937_64 random(2);
    int planned = 0;
    for (int i = 0; i < scaled(2000); ++i) {
        const auto plan = Planner(model_).lin(randomLin(model_, random));
        if (!plan) {
            continue;
        }
        ++planned;
        constexpr double cycle = 0.004;
        JointVector before = plan->start();
        for (double t = 0; t <= plan->duration().count() + cycle; t += cycle) {
            const JointVector q = plan->sample(Seconds(t)).position;
            for (std::size_t axis = 0; axis < q.size(); ++axis) {
                ASSERT_LE(std::abs(q[axis] - before[axis]),
                          1.01 * cycle * model_.limits(axis).velocity);
            }
            before = q;
        }
    }
    EXPECT_GT(planned, scaled(2000) / 5);
}

TEST_P(AcceptanceOf, SetPointVelocityAndAccelerationAreTheDerivativesOfThePosition) {
    const auto plan = Planner(model_).lin(vertical(model_, 0.08));
    ASSERT_TRUE(plan);
    constexpr double h = 1e-4;
    for (double t = 0.05; t < plan->duration().count() - 0.05; t += 0.05) {
        const SetPoint at = plan->sample(Seconds(t));
        const JointVector after = plan->sample(Seconds(t + h)).position;
        const JointVector before = plan->sample(Seconds(t - h)).position;
        for (std::size_t i = 0; i < at.position.size(); ++i) {
            EXPECT_NEAR(at.velocity[i], (after[i] - before[i]) / (2 * h), 2e-4);
            EXPECT_NEAR(at.acceleration[i], (after[i] - 2 * at.position[i] + before[i]) / (h * h),
                        2e-2);
        }
    }
}

/// All set-points of some random motions; what could not be planned leaves its text's length.
std::vector<double> fingerprint(const RobotModel& model) {
    std::mt19937_64 random(4);
    std::vector<double> values;
    for (int i = 0; i < 12; ++i) {
        const auto plan = Planner(model).lin(randomLin(model, random));
        if (!plan) {
            values.push_back(static_cast<double>(plan.error().error.message.size()));
            continue;
        }
        for (double t = 0; t < plan->duration().count(); t += 0.05) {
            const SetPoint point = plan->sample(Seconds(t));
            values.insert(values.end(), point.position.begin(), point.position.end());
            values.insert(values.end(), point.acceleration.begin(), point.acceleration.end());
        }
        const motion::Pose pose = plan->endPose();
        const auto numeric = model.kinematics().inverseNumerically(
            plan->toolPose(randomPosition(model, random)), {model.home(), {}, {}});
        values.insert(values.end(), numeric->begin(), numeric->end());
        values.push_back(pose.translation.sum());
    }
    return values;
}

TEST_P(AcceptanceOf, AHundredRepeatsGiveTheSameBitsUnderLoadToo) {
    const std::vector<double> first = fingerprint(model_);
    ASSERT_GT(first.size(), 100U);
    // Others keep both cores and the allocator busy meanwhile.
    std::vector<std::jthread> load;
    for (int i = 0; i < 3; ++i) {
        load.emplace_back([this](const std::stop_token& stop) {
            while (!stop.stop_requested()) {
                fingerprint(model_);
            }
        });
    }
    for (int i = 0; i < 100; ++i) {
        const std::vector<double> again = fingerprint(model_);
        ASSERT_EQ(again.size(), first.size());
        ASSERT_EQ(std::memcmp(again.data(), first.data(), first.size() * sizeof(double)), 0);
    }
}

TEST_P(AcceptanceOf, AHalfTurnIsTheSameWayEveryTime) {
    LinRequest request = vertical(model_, 0);
    request.reference = TargetReference::relative_tool;
    for (const double angle : {std::numbers::pi, -std::numbers::pi}) {
        request.target.rotation = motion::fromRotationVector({0, 0, angle});
        const auto plan = Planner(model_).lin(request);
        if (!plan) {
            EXPECT_EQ(plan.error().reason, RefusalReason::joint_limit);
            continue;
        }
        const Pose quarter = plan->poseAt(0.5);
        const Eigen::Vector3d turned =
            motion::rotationVectorBetween(plan->poseAt(0).rotation, quarter.rotation);
        EXPECT_NEAR(turned.norm(), std::numbers::pi / 2, 1e-9);
        EXPECT_GT(turned.z() + 1e-9, 0.0);
    }
}

TEST(Acceptance, AHundredLapsOfTheSquareKeepTheElbowOfTheSevenAxisArm) {
    const RobotModel model = loadRobot("iiwa7");
    const std::array<Eigen::Vector3d, 4> sides{
        Eigen::Vector3d(0, 0.1, 0), Eigen::Vector3d(0, 0, 0.1), Eigen::Vector3d(0, -0.1, 0),
        Eigen::Vector3d(0, 0, -0.1)};
    JointVector q = model.home();
    q[2] = 0.2;
    const JointVector start = q;
    for (int lap = 0; lap < 100; ++lap) {
        for (const Eigen::Vector3d& side : sides) {
            LinRequest request = vertical(model, 0);
            request.start = q;
            request.target.translation = side;
            const auto plan = Planner(model).lin(request);
            ASSERT_TRUE(plan) << plan.error().error.message;
            q = plan->end();
        }
    }
    EXPECT_LE(maxDifference(q, start), 1e-9);
}

TEST(Acceptance, TheArmAngleCanBeChangedAlongALine) {
    const RobotModel model = loadRobot("iiwa7");
    LinRequest request = vertical(model, 0.05);
    const double before = model.kinematics().redundancyAngle(request.start);
    request.redundancy_angle = before + 0.4;
    const auto plan = Planner(model).lin(request);
    ASSERT_TRUE(plan) << plan.error().error.message;
    EXPECT_NEAR(model.kinematics().redundancyAngle(plan->end()), before + 0.4, 1e-9);
    EXPECT_NEAR(model.kinematics().redundancyAngle(plan->positionAt(0.5)), before + 0.2, 1e-9);
}

TEST(Acceptance, ALineThroughTheWristSingularityRunsIfTheAxesStayContinuous) {
    const RobotModel model = loadRobot("edo");
    // The wrist stretches through axis 5 = 0 while the tool turns about axis 5.
    LinRequest request;
    request.start = JointVector{0, 0.1, 1.2, 0, 0.3, 0};
    request.reference = TargetReference::relative_base;
    request.target.rotation = motion::fromRotationVector({0, -0.6, 0});
    const auto plan = Planner(model).lin(request);
    ASSERT_TRUE(plan) << plan.error().error.message;
    EXPECT_LT(maxDifference(plan->end(), plan->start()), 1.0);
}

/// Largest speed of an axis as a share of its limit, of all samples of a plan.
double largestShareOfVelocity(const RobotModel& model, const Trajectory& plan, double step) {
    double most = 0;
    JointVector before = plan.start();
    for (double t = step; t < plan.duration().count(); t += step) {
        const JointVector q = plan.sample(Seconds(t)).position;
        for (std::size_t axis = 0; axis < q.size(); ++axis) {
            most = std::max(
                most, std::abs(q[axis] - before[axis]) / (step * model.limits(axis).velocity));
        }
        before = q;
    }
    return most;
}

/// Of the tool frame, from sample to sample [m/s].
double largestToolSpeed(const Trajectory& plan, double step) {
    double most = 0;
    Pose before = plan.toolPose(plan.start());
    for (double t = step; t < plan.duration().count(); t += step) {
        const Pose pose = plan.toolPose(plan.sample(Seconds(t)).position);
        most = std::max(most, distanceBetween(before, pose) / step);
        before = pose;
    }
    return most;
}

TEST(Acceptance, ALineThatMissesAWristSingularityByAHairRunsThroughIt) {
    const RobotModel model = loadRobot("edo");
    int planned = 0;
    for (const double miss : {1e-12, 1e-9, 1e-7, 1e-6, 1e-5, 3e-5, 1e-4, 1e-3}) {
        LinRequest request;
        request.start = JointVector{0, 0.1, 1.2, 0, 0.3, 0};
        request.reference = TargetReference::relative_base;
        request.target.rotation = motion::fromRotationVector({miss, -0.6, 0});
        if (const auto plan = Planner(model).lin(request)) {
            ++planned;
            EXPECT_LE(largestShareOfVelocity(model, *plan, 1e-4), 1.001) << miss;
        }
    }
    EXPECT_GE(planned, 4) << "they need not be refused";
}

TEST(Acceptance, ALineOverTheBaseAxisHasNoAxisJump) {
    const RobotModel model = loadRobot("edo");
    // The centre of the wrist passes the axis of axis 1 at 0.1 micrometres and at less.
    struct Over {
        JointVector start;
        double x;
        double y;
    };
    const Over near{{-2.56781734947911, -0.6263772446771323, 1.3397017795678294,
                     0.00015238704671061143, -1.2878714897829975, -0.5290992379176127},
                    0.08683539182502958,
                    0.056122331034649996};
    const Over nearer{{2.522117177591988, -0.7040439949260542, 1.4531035335906795,
                       0.005321996283000452, -0.37200259744324304, -2.44672726986654},
                      0.07558927293115035,
                      -0.05390635932829753};
    for (const Over& over : {near, nearer}) {
        LinRequest request;
        request.start = over.start;
        request.reference = TargetReference::relative_base;
        request.target.translation = {over.x, over.y, 0};
        const auto plan = Planner(model).lin(request);
        ASSERT_TRUE(plan) << plan.error().error.message;
        EXPECT_LE(largestShareOfVelocity(model, *plan, 1e-4), 1.001) << over.x;
    }
}

TEST(Acceptance, AHalfTurnOfTheToolBesideAWristSingularityHasNoAxisJump) {
    const RobotModel model = loadRobot("iiwa14");
    PathRequest request;
    request.lin.start = JointVector{-0.06439955171679973, 0.7858639380188989, 0.39656856424825404,
                                    -1.3134878070537581,  0.1484855933362298, 1.2570147413205377,
                                    0.2621647180682465};
    request.lin.max_velocity = {0.05297375999728604, 0.2159366437982967, 0.0021140865455736954};
    request.lin.max_acceleration = {
        0, 0, 0, 1.977514102259885, 0.03494202714741432, 0.26765764963348193};
    request.lin.speed_override = 0.03077183372678933;
    request.lin.reference = TargetReference::relative_tool;
    PathWaypoint turn;
    turn.target.translation = {0, 0, -0.0004908865582468778};
    turn.target.rotation = {6.123233995736766e-17, 0.5787241654440792, 0.6162528899889638,
                            -0.5341448454411072};
    turn.blend_radius = 0.00026926474315007047;
    PathWaypoint step;
    step.target.translation = {-7.768604369171346e-05, -0.00019731061711140787,
                               0.0004950226324172849};
    request.waypoints = {turn, step};
    const auto plan = Planner(model).path(request);
    ASSERT_TRUE(plan) << plan.error().error.message;
    EXPECT_LE(largestShareOfVelocity(model, *plan, 1e-3), 0.2)
        << "by the exact positions axis 5 turns there and back by 2.8 rad within 4 ms";
    const double limit = request.lin.speed_override * request.lin.max_velocity[2];  // [m/s]
    EXPECT_LE(largestToolSpeed(*plan, 1e-3), 1.02 * limit)
        << "beside the singularity the tool leaves its path by micrometres";
}

TEST(Acceptance, ALineCloseByASingularityIsSlowOrRefusedButNeverTooFast) {
    const RobotModel model = loadRobot("ur5");
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> unit(-1, 1);
    int refused = 0;
    for (int i = 0; i < scaled(30); ++i) {
        LinRequest request = vertical(model, 0);
        request.start[4] = 0.3;  // the line turns the wrist past 0, a little beside it
        request.target.rotation = motion::fromRotationVector(
            {0.02 * unit(random), 0.02 * unit(random), -0.6 * (unit(random) > 0 ? 1 : -1)});
        request.target.translation = {0.0, 0.05 * unit(random), 0};
        const auto plan = Planner(model).lin(request);
        if (!plan) {
            ++refused;
            continue;
        }
        constexpr double cycle = 0.001;
        JointVector before = plan->start();
        for (double t = 0; t < plan->duration().count(); t += cycle) {
            const JointVector q = plan->sample(Seconds(t)).position;
            for (std::size_t axis = 0; axis < q.size(); ++axis) {
                ASSERT_LE(std::abs(q[axis] - before[axis]),
                          1.001 * cycle * model.limits(axis).velocity)
                    << i << " axis " << axis << " at " << t;
            }
            before = q;
        }
    }
    EXPECT_LT(refused, scaled(30));
}

}  // namespace
}  // namespace metier::motion
