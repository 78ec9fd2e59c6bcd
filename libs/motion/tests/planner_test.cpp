#include "metier/motion/planner.hpp"

#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <random>

#include "kdl_oracle.hpp"
#include "metier/motion/rotation.hpp"
#include "test_robots.hpp"

namespace metier::motion {
namespace {

using motion::Pose;
using testing::HasSubstr;

/// Largest finite differences of a motion sampled at a cycle, as shares of the axis limits.
struct Shares {
    double velocity = 0;
    double acceleration = 0;
    double jerk = 0;
};

std::vector<JointVector> sampled(const Trajectory& trajectory, double cycle) {
    std::vector<JointVector> result;
    const auto count = static_cast<int>(std::ceil(trajectory.duration().count() / cycle));
    for (int i = -3; i <= count + 3; ++i) {
        result.push_back(trajectory.sample(Seconds(i * cycle)).position);
    }
    return result;
}

Shares jointShares(const RobotModel& model, const std::vector<JointVector>& samples, double cycle) {
    Shares shares;
    for (std::size_t k = 3; k < samples.size(); ++k) {
        for (std::size_t i = 0; i < model.axisCount(); ++i) {
            const auto q = [&](std::size_t n) { return samples[k - n][i]; };
            const JointLimits& limits = model.limits(i);
            const double v = (q(0) - q(1)) / cycle;
            const double a = (q(0) - 2 * q(1) + q(2)) / (cycle * cycle);
            const double j = (q(0) - 3 * q(1) + 3 * q(2) - q(3)) / (cycle * cycle * cycle);
            shares.velocity = std::max(shares.velocity, std::abs(v) / limits.velocity);
            shares.acceleration = std::max(shares.acceleration, std::abs(a) / limits.acceleration);
            shares.jerk = std::max(shares.jerk, std::abs(j) / limits.jerk);
        }
    }
    return shares;
}

/// Largest finite differences of the tool frame, as shares of the request's and robot's limits.
struct ToolShares {
    double velocity = 0;
    double acceleration = 0;
    double jerk = 0;

    void add(const std::array<Eigen::Vector3d, 3>& derivatives,
             const std::array<double, 3>& limits) {
        velocity = std::max(velocity, derivatives[0].norm() / limits[0]);
        acceleration = std::max(acceleration, derivatives[1].norm() / limits[1]);
        jerk = std::max(jerk, derivatives[2].norm() / limits[2]);
    }
};

/// The first three finite differences of a vector that comes once a cycle.
class Differences {
public:
    explicit Differences(double cycle) : cycle_(cycle) {}
    /// \param velocity the first difference
    std::array<Eigen::Vector3d, 3> take(const Eigen::Vector3d& velocity) {
        const Eigen::Vector3d acceleration = (velocity - velocity_) / cycle_;
        const Eigen::Vector3d jerk = (acceleration - acceleration_) / cycle_;
        velocity_ = velocity;
        acceleration_ = acceleration;
        return {velocity, acceleration, jerk};
    }

private:
    double cycle_;
    Eigen::Vector3d velocity_ = Eigen::Vector3d::Zero();
    Eigen::Vector3d acceleration_ = Eigen::Vector3d::Zero();
};

/// \param poses of the tool frame, one a cycle, from rest
ToolShares toolShares(const RobotModel& model, const LinRequest& request,
                      const std::vector<Pose>& poses) {
    const CartesianLimits& own = model.cartesianLimits();
    const double v = std::min(request.max_velocity[0], own.velocity);
    const double a = std::min(request.max_acceleration[0], own.acceleration);
    const double w = std::min(request.max_velocity[3], own.angular_velocity);
    const double b = std::min(request.max_acceleration[3], own.angular_acceleration);
    const double cycle = model.cycleTime();
    Differences translation(cycle);
    Differences rotation(cycle);
    ToolShares shares;
    for (std::size_t k = 1; k < poses.size(); ++k) {
        const Pose& before = poses[k - 1];
        const Pose& now = poses[k];
        shares.add(translation.take((now.translation - before.translation) / cycle),
                   {v, a, std::min(own.jerk, 20 * a)});
        shares.add(
            rotation.take(motion::rotationVectorBetween(before.rotation, now.rotation) / cycle),
            {w, b, std::min(own.angular_jerk, 20 * b)});
    }
    return shares;
}

/// The time of the slowest axis if each moved alone.
double optimum(const RobotModel& model, const JointVector& from, const JointVector& to) {
    double slowest = 0;
    for (std::size_t i = 0; i < from.size(); ++i) {
        const JointLimits& own = model.limits(i);
        const Profile alone = Profile::toRest({}, std::abs(to[i] - from[i]),
                                              {own.velocity, own.acceleration, own.jerk});
        slowest = std::max(slowest, alone.duration());
    }
    return slowest;
}

/// Random line that starts near home, so that most of them can be run.
LinRequest randomLin(const RobotModel& model, std::mt19937_64& random) {
    std::uniform_real_distribution<double> unit(-1, 1);
    LinRequest request;
    request.start = model.home();
    for (double& q : request.start) {
        q += 0.3 * unit(random);
    }
    request.reference = TargetReference::relative_base;
    request.target.translation = 0.2 * Eigen::Vector3d(unit(random), unit(random), unit(random));
    request.target.rotation =
        motion::fromRotationVector(0.5 * Eigen::Vector3d(unit(random), unit(random), unit(random)));
    request.max_velocity = {0.25, 0.25, 0.25, 0.5, 0.5, 0.5};
    request.max_acceleration = {1.2, 1.2, 1.2, 2.5, 2.5, 2.5};
    return request;
}

using PtpOf = EachRobot;
INSTANTIATE_TEST_SUITE_P(Robots, PtpOf, testing::ValuesIn(kRobots), robotName);

/// Random PTP to a pose, and the end of a line from there.
PtpRequest randomPtpBeforeLine(const RobotModel& model, std::mt19937_64& random) {
    std::uniform_real_distribution<double> unit(-1, 1);
    PtpRequest request;
    request.start = randomPosition(model, random);
    const Pose target = model.kinematics().forward(randomPosition(model, random));
    request.target = target;
    Pose next = target;
    next.translation += 0.3 * Eigen::Vector3d(unit(random), unit(random), unit(random));
    request.next_line = next;
    return request;
}

TEST_P(PtpOf, EndsInAJointPositionFromWhichTheNextLineIsPossible) {
    std::mt19937_64 random(11);
    const Planner planner(model_);
    int by_the_nearest = 0;
    int by_another = 0;
    for (int i = 0; i < scaled(200); ++i) {
        const auto request = randomPtpBeforeLine(model_, random);
        auto without = request;
        without.next_line.reset();
        const auto line = [&](const Planned<Trajectory>& ptp) {
            LinRequest next;
            next.target = *request.next_line;
            next.start = ptp ? ptp->end() : JointVector();
            return ptp && planner.lin(next);
        };
        const auto nearest = planner.ptp(without);
        const auto plan = planner.ptp(request);
        if (line(nearest)) {
            ++by_the_nearest;
            ASSERT_TRUE(plan) << plan.error().error.message;
            EXPECT_LT(maxDifference(plan->end(), nearest->end()), 1e-9) << "no detour";
        } else if (plan) {
            ++by_another;
            EXPECT_TRUE(line(plan)) << "number " << i;
        }
    }
    EXPECT_GT(by_the_nearest, 0);
    EXPECT_GT(by_another, 0);
}

TEST_P(PtpOf, IsRefusedIfTheNextLineIsPossibleFromNowhere) {
    PtpRequest request;
    request.start = model_.home();
    request.target = model_.kinematics().forward(model_.home());
    request.next_line = std::get<Pose>(request.target);
    request.next_line->translation.x() += 100;
    const auto plan = Planner(model_).ptp(request);
    ASSERT_FALSE(plan);
    EXPECT_EQ(plan.error().reason, RefusalReason::unreachable);
    EXPECT_THAT(plan.error().error.message, HasSubstr("the next line is possible from none of "));
}

TEST_P(PtpOf, RunsStraightInJointSpaceWithinTheLimitsOfEveryAxis) {
    std::mt19937_64 random(1);
    const double cycle = model_.cycleTime();
    for (int i = 0; i < scaled(1000); ++i) {
        PtpRequest request;
        request.start = randomPosition(model_, random);
        request.target = randomPosition(model_, random);
        const auto plan = Planner(model_).ptp(request);
        if (!plan && plan.error().reason == RefusalReason::collision) {
            continue;
        }
        ASSERT_TRUE(plan) << plan.error().error.message;
        const auto samples = sampled(*plan, cycle);
        const Shares shares = jointShares(model_, samples, cycle);
        ASSERT_LE(shares.velocity, 1.0001);
        ASSERT_LE(shares.acceleration, 1.0001);
        ASSERT_LE(shares.jerk, 1.0001);
        const JointVector target = std::get<JointVector>(request.target);
        // Axes of unlike limits share one profile: each limit is that of the axis it binds first.
        ASSERT_GE(plan->duration().count(), optimum(model_, request.start, target) - 1e-9);
        ASSERT_LE(maxDifference(samples.back(), target), 1e-9);
        ASSERT_LE(maxDifference(samples.front(), request.start), 1e-9);
        for (const JointVector& q : samples) {
            const double s = (q[0] - request.start[0]) / (target[0] - request.start[0]);
            JointVector line = request.start;
            line.view() += s * (target.view() - request.start.view());
            ASSERT_LE(maxDifference(q, line), 1e-9);
        }
    }
}

TEST_P(PtpOf, TakesTheTimeOfItsSlowestAxis) {
    PtpRequest request;
    request.start = model_.home();
    JointVector target = model_.home();
    target[0] += 1.0;
    request.target = target;
    const JointLimits& limits = model_.limits(0);
    const double v = limits.velocity;
    const double a = limits.acceleration;
    const double optimum = v * v / a + v * a / limits.jerk < 1.0
                               ? 1.0 / v + v / a + a / limits.jerk
                               : Profile::toRest({}, 1.0, {v, a, limits.jerk}).duration();
    const auto plan = Planner(model_).ptp(request);
    ASSERT_TRUE(plan);
    EXPECT_LE(plan->duration().count(), 1.001 * optimum);
    EXPECT_GE(plan->duration().count(), 0.999 * optimum);
}

TEST_P(PtpOf, ReachesAPoseWithEveryToolFrame) {
    ChainDescription chain = model_.chain();
    chain.tools = {{"gripper", {{0, 0, 0.1}, Eigen::Quaterniond::Identity()}},
                   {"bent", {{0.05, 0, 0.02}, motion::fromRotationVector({0.3, -0.2, 1.0})}}};
    const RobotModel model = RobotModel::fromChain(chain).value();
    for (const std::string name : {"flange", "gripper", "bent"}) {
        const Pose flange_from_tool = model.tool(name)->flange_from_tool;
        JointVector there = model.home();
        there[0] += 0.3;
        PtpRequest request;
        request.start = model.home();
        request.tool_frame = name;
        request.target = model.kinematics().forward(there) * flange_from_tool;
        const auto plan = Planner(model).ptp(request);
        ASSERT_TRUE(plan) << plan.error().error.message;
        EXPECT_LT(poseError(plan->endPose(), std::get<Pose>(request.target)), 1e-9);
        EXPECT_LT(maxDifference(plan->end(), there), 1e-8);
    }
}

using LinOf = EachRobot;
INSTANTIATE_TEST_SUITE_P(Robots, LinOf, testing::ValuesIn(kRobots), robotName);

TEST_P(LinOf, StaysOnTheLineAndWithinTheLimits) {
    KdlOracle oracle(model_.chain());
    std::mt19937_64 random(2);
    const double cycle = model_.cycleTime();
    int planned = 0;
    for (int i = 0; i < scaled(1000); ++i) {
        const LinRequest request = randomLin(model_, random);
        const auto plan = Planner(model_).lin(request);
        if (!plan) {
            continue;
        }
        ++planned;
        const auto samples = sampled(*plan, cycle);
        const Shares shares = jointShares(model_, samples, cycle);
        ASSERT_LE(shares.velocity, 1.001) << i;
        ASSERT_LE(shares.acceleration, 1.02) << i;
        ASSERT_LE(shares.jerk, 1.02) << i;
        std::vector<Pose> poses;
        for (const JointVector& q : samples) {
            poses.push_back(oracle.forward(q));
            const PathDeviation off = plan->deviation(poses.back());
            ASSERT_LE(off.distance, 1e-9);
            ASSERT_LE(off.angle, 1e-7);
        }
        const ToolShares tool = toolShares(model_, request, poses);
        ASSERT_LE(tool.velocity, 1.001) << i;
        ASSERT_LE(tool.acceleration, 1.01) << i;
        ASSERT_LE(tool.jerk, 1.01) << i;
        const Pose start = oracle.forward(request.start);
        ASSERT_LT(motion::distanceBetween(
                      oracle.forward(samples.back()),
                      {start.translation + request.target.translation, start.rotation}),
                  1e-9);
    }
    EXPECT_GE(planned, scaled(1000) / 6);
}

TEST_P(LinOf, RunsSlowerInsteadOfFailingWhereAnAxisLimits) {
    LinRequest request;
    request.start = model_.home();
    request.reference = TargetReference::relative_base;
    request.target.translation = {0, 0, 0.1};
    request.max_velocity = {0.25, 0.25, 0.25, 1, 1, 1};
    const auto plan = Planner(model_).lin(request);
    ASSERT_TRUE(plan) << plan.error().error.message;
    const Shares shares = jointShares(model_, sampled(*plan, 0.001), 0.001);
    EXPECT_LE(shares.velocity, 1.001);
    EXPECT_LE(shares.acceleration, 1.02);
}

TEST_P(LinOf, ClosesASquareWithoutDriftOverManyLaps) {
    const std::array<Eigen::Vector3d, 4> sides{
        Eigen::Vector3d(0, 0.1, 0), Eigen::Vector3d(0, 0, 0.1), Eigen::Vector3d(0, -0.1, 0),
        Eigen::Vector3d(0, 0, -0.1)};
    JointVector q = model_.home();
    for (int lap = 0; lap < scaled(1000); ++lap) {
        for (const Eigen::Vector3d& side : sides) {
            LinRequest request;
            request.start = q;
            request.reference = TargetReference::relative_base;
            request.target.translation = side;
            const auto plan = Planner(model_).lin(request);
            ASSERT_TRUE(plan) << plan.error().error.message;
            q = plan->end();
        }
    }
    EXPECT_LE(maxDifference(q, model_.home()), 1e-9);
}

TEST_P(LinOf, FinishesMovesOfNoAndTinyLength) {
    for (const double length : {0.0, 1e-12, 1e-9, 1e-6}) {
        LinRequest request;
        request.start = model_.home();
        request.reference = TargetReference::relative_tool;
        request.target.translation = {length, 0, 0};
        const auto plan = Planner(model_).lin(request);
        ASSERT_TRUE(plan) << plan.error().error.message;
        EXPECT_LT(plan->duration().count(), 0.2);
        EXPECT_TRUE(plan->sample(plan->duration() / 2).position.allFinite());
        EXPECT_LT(maxDifference(plan->end(), model_.home()), 1e-4);
    }
}

TEST_P(LinOf, TurnsOnTheSpot) {
    LinRequest request;
    request.start = model_.home();
    request.reference = TargetReference::relative_tool;
    request.target.rotation = motion::fromRotationVector({0, 0, 0.5});
    const auto plan = Planner(model_).lin(request);
    ASSERT_TRUE(plan) << plan.error().error.message;
    for (const JointVector& q : sampled(*plan, 0.01)) {
        EXPECT_LE(plan->deviation(plan->toolPose(q)).distance, 1e-9);
    }
}

TEST_P(LinOf, RefusesALineOutOfReachWithTheFractionWhereItFails) {
    LinRequest request;
    request.start = model_.home();
    request.reference = TargetReference::relative_base;
    request.target.translation = {3, 0, 0};
    const auto plan = Planner(model_).lin(request);
    ASSERT_FALSE(plan);
    EXPECT_GT(plan.error().fraction, 0.0);
    EXPECT_LT(plan.error().fraction, 1.0);
    EXPECT_THAT(plan.error().error.message, HasSubstr("% of the path"));
}

TEST_P(LinOf, GivesTheSameBitsEveryTimeAndAtEveryRate) {
    std::mt19937_64 random(3);
    LinRequest request = randomLin(model_, random);
    auto first = Planner(model_).lin(request);
    while (!first) {
        request = randomLin(model_, random);
        first = Planner(model_).lin(request);
    }
    const auto again = Planner(model_).lin(request);
    ASSERT_TRUE(again);
    for (int i = 0; i < 100; ++i) {
        const Seconds time = first->duration() * i / 100;
        EXPECT_EQ(first->sample(time).position, again->sample(time).position);
    }
}

TEST_P(LinOf, JointLinearEndsAtTheTargetJointPosition) {
    JointLinearRequest request;
    request.lin.start = model_.home();
    request.target = model_.home();
    request.target[0] += 0.2;
    request.target[1] += 0.1;
    request.target[2] -= 0.1;
    const auto plan = Planner(model_).jointLinear(request);
    ASSERT_TRUE(plan) << plan.error().error.message;
    EXPECT_LE(maxDifference(plan->end(), request.target), 1e-8);
}

TEST_P(LinOf, StretchesToALongerDuration) {
    LinRequest request;
    request.start = model_.home();
    request.reference = TargetReference::relative_base;
    request.target.translation = {0, 0, 0.05};
    const auto plan = Planner(model_).lin(request);
    ASSERT_TRUE(plan);
    const Trajectory slow = plan->stretchedTo(1.7 * plan->duration());
    EXPECT_NEAR(slow.duration().count(), 1.7 * plan->duration().count(), 1e-9);
    for (int i = 0; i <= 10; ++i) {
        EXPECT_LE(maxDifference(slow.sample(slow.duration() * i / 10).position,
                                plan->sample(plan->duration() * i / 10).position),
                  1e-9);
    }
}

TEST(Planner, RefusesWhatMakesNoSense) {
    const RobotModel model = loadRobot("ur5");
    const Planner planner(model);
    LinRequest request;
    request.start = model.home();
    request.target = model.kinematics().forward(model.home());

    auto wrong = request;
    wrong.start = JointVector(7);
    EXPECT_EQ(planner.lin(wrong).error().error.code, Errc::invalid_argument);
    wrong = request;
    wrong.target.translation.x() = std::nan("");
    EXPECT_EQ(planner.lin(wrong).error().error.code, Errc::invalid_argument);
    wrong = request;
    wrong.max_velocity[2] = -1;
    EXPECT_EQ(planner.lin(wrong).error().error.code, Errc::out_of_range);
    wrong = request;
    wrong.speed_override = 0;
    EXPECT_EQ(planner.lin(wrong).error().error.code, Errc::out_of_range);
    wrong = request;
    wrong.tool_frame = "drill";
    EXPECT_EQ(planner.lin(wrong).error().error.code, Errc::not_found);
}

TEST(Planner, NamesAxisValueLimitAndUnitOfATargetBeyondALimit) {
    const RobotModel model = loadRobot("edo");
    PtpRequest request;
    request.start = model.home();
    JointVector target = model.home();
    target[1] = 2.0;
    request.target = target;
    const auto plan = Planner(model).ptp(request);
    ASSERT_FALSE(plan);
    EXPECT_EQ(plan.error().reason, RefusalReason::joint_limit);
    EXPECT_EQ(plan.error().axis, 1U);
    EXPECT_THAT(plan.error().error.message, HasSubstr("axis 2: 2.0000 rad over limit 1.7279 rad"));
}

TEST(Planner, AssessesAMoveAsTheStartWould) {
    const RobotModel model = loadRobot("ur5");
    LinRequest request;
    request.start = model.home();
    request.reference = TargetReference::relative_base;
    request.target.translation = {0, 0, 0.1};
    const auto plan = Planner(model).lin(request);
    const Feasibility feasible = assess(plan, 11);
    EXPECT_FALSE(feasible.refusal);
    EXPECT_EQ(feasible.duration, plan->duration());
    ASSERT_EQ(feasible.preview.size(), 11U);
    EXPECT_EQ(feasible.preview.back(), plan->end());
    request.target.translation = {9, 0, 0};
    EXPECT_TRUE(assess(Planner(model).lin(request), 11).refusal);
}

TEST(Planner, LimitsTheLengthOfTheVelocityWhereThreeLimitsAreEqual) {
    const RobotModel model = loadRobot("iiwa7");
    LinRequest request;
    request.start = model.home();
    request.reference = TargetReference::relative_base;
    request.target.translation = {-0.1, 0.1, 0.1};
    request.max_velocity = {0.1, 0.1, 0.1, 1, 1, 1};
    const auto plan = Planner(model).lin(request);
    ASSERT_TRUE(plan) << plan.error().error.message;
    double fastest = 0;
    for (double t = 0; t < plan->duration().count(); t += 0.001) {
        const auto at = [&](double time) {
            return plan->toolPose(plan->sample(Seconds(time)).position).translation;
        };
        fastest = std::max(fastest, (at(t + 0.001) - at(t)).norm() / 0.001);
    }
    EXPECT_NEAR(fastest, 0.1, 1e-4);
}

}  // namespace
}  // namespace metier::motion
