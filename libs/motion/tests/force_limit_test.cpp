#include "metier/motion/force_limit.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "metier/motion/motion_run.hpp"
#include "metier/motion/planner.hpp"
#include "test_robots.hpp"

namespace metier::motion {
namespace {

using motion::Wrench;
using testing::HasSubstr;

constexpr double kLimit = 50.0;

ForceLimit limitOf(const WrenchLimits& limits, double cycle = 0.002) {
    return ForceLimit::create(limits, Seconds(cycle)).value();
}

/// The same limit for both lengths and all six components.
WrenchLimits everywhere(double limit) {
    WrenchLimits limits{limit, limit, {}};
    limits.components.fill(limit);
    return limits;
}

Wrench along(std::size_t component, double value) {
    Wrench wrench;
    (component < 3 ? wrench.force : wrench.torque)[static_cast<Eigen::Index>(component % 3)] =
        value;
    return wrench;
}

/// Each of the six components, and the two lengths with components that are all below.
std::vector<Wrench> steadyWrenches(double value) {
    std::vector<Wrench> wrenches;
    for (std::size_t i = 0; i < 6; ++i) {
        wrenches.push_back(along(i, value));
        wrenches.push_back(along(i, -value));
    }
    const Eigen::Vector3d slanted = value * Eigen::Vector3d(1, -1, 1).normalized();
    wrenches.push_back({slanted, Eigen::Vector3d::Zero()});
    wrenches.push_back({Eigen::Vector3d::Zero(), slanted});
    return wrenches;
}

/// Whether a wrench that sets in after a while without any is ever beyond the limit.
bool trips(ForceLimit limit, const Wrench& wrench) {
    limit.check({});
    for (int i = 0; i < 10000; ++i) {
        if (limit.check(wrench)) {
            return true;
        }
    }
    return false;
}

TEST(ForceLimit, NeverTripsForASteadyWrenchBelowTheLimitAndAlwaysAboveIt) {
    for (const double cycle : {0.001, 0.002, 0.008, 0.01}) {
        for (const Wrench& wrench : steadyWrenches(0.95 * kLimit)) {
            EXPECT_FALSE(trips(limitOf(everywhere(kLimit), cycle), wrench));
        }
        for (const Wrench& wrench : steadyWrenches(1.05 * kLimit)) {
            EXPECT_TRUE(trips(limitOf(everywhere(kLimit), cycle), wrench));
        }
    }
}

TEST(ForceLimit, EachLimitWorksAlone) {
    EXPECT_TRUE(trips(limitOf({kLimit, 0, {}}), along(1, 60)));
    EXPECT_FALSE(trips(limitOf({kLimit, 0, {}}), along(4, 60)));
    EXPECT_TRUE(trips(limitOf({0, kLimit, {}}), along(4, 60)));
    EXPECT_FALSE(trips(limitOf({0, kLimit, {}}), along(1, 60)));
    EXPECT_TRUE(trips(limitOf({0, 0, {0, 0, kLimit, 0, 0, 0}}), along(2, -60)));
    EXPECT_FALSE(trips(limitOf({0, 0, {0, 0, kLimit, 0, 0, 0}}), along(0, 60)));
}

TEST(ForceLimit, TellsOfAnExcessInTheCycleInWhichTheFilteredForceIsBeyondTheLimit) {
    constexpr double cycle = 0.002;
    ForceLimit limit = limitOf({kLimit, 0, {}}, cycle);
    double filtered = 0;
    for (int i = 0; i < 200; ++i) {
        const double force = 400.0 * i * cycle;
        filtered += (1 - std::exp(-2 * std::numbers::pi * 20 * cycle)) * (force - filtered);
        EXPECT_EQ(limit.check(along(2, force)).has_value(), filtered > kLimit) << i;
        EXPECT_NEAR(limit.filtered().force.z(), filtered, 1e-9);
    }
}

TEST(ForceLimit, DampsAVibrationOf20HzAndMoreButNotASlowPush) {
    constexpr double cycle = 0.001;
    const auto largest = [&](double frequency) {
        ForceLimit limit = limitOf({1e6, 0, {}}, cycle);
        double value = 0;
        for (int i = 0; i < 4000; ++i) {
            limit.check(along(0, std::sin(2 * std::numbers::pi * frequency * i * cycle)));
            value = i > 2000 ? std::max(value, limit.filtered().force.x()) : value;
        }
        return value;
    };
    EXPECT_NEAR(largest(20), std::sqrt(0.5), 0.05);
    EXPECT_LT(largest(200), 0.15);
    EXPECT_GT(largest(1), 0.99);
}

TEST(ForceLimit, TripsAtOnceIfTheFirstWrenchIsBeyondTheLimitAlready) {
    EXPECT_TRUE(limitOf({kLimit, 0, {}}).check(along(0, 60)));
    EXPECT_FALSE(limitOf({kLimit, 0, {}}).check(along(0, 40)));
}

TEST(ForceLimit, TakesAValueThatIsNotFiniteForAnExcess) {
    ForceLimit limit = limitOf({kLimit, 0, {}});
    const auto excess = limit.check(along(4, std::nan("")));
    ASSERT_TRUE(excess);
    EXPECT_EQ(excess->quantity, ForceExcess::Quantity::not_finite);
    EXPECT_EQ(toError(*excess).code, Errc::device_fault);
    EXPECT_THAT(toError(*excess).message, HasSubstr("torque about y: not finite"));
    EXPECT_FALSE(limit.check(along(0, 10))) << "one bad value must not stay in the filter";
}

TEST(ForceLimit, NamesQuantityValueLimitAndUnit) {
    ForceLimit force = limitOf({0, 0, {0, 0, kLimit, 0, 0, 0}});
    EXPECT_THAT(toError(*force.check(along(2, -60))).message,
                HasSubstr("force along z: -60.00 N over limit 50.00 N"));
    ForceLimit torque = limitOf({0, 5, {}});
    EXPECT_THAT(toError(*torque.check(along(3, 6))).message,
                HasSubstr("torque: 6.00 Nm over limit 5.00 Nm"));
}

TEST(ForceLimit, RefusesLimitsThatMakeNoSense) {
    EXPECT_FALSE(ForceLimit::create({}, Seconds(0.002)));
    EXPECT_FALSE(ForceLimit::create({-1, 0, {}}, Seconds(0.002)));
    EXPECT_FALSE(ForceLimit::create({0, std::nan(""), {}}, Seconds(0.002)));
    EXPECT_FALSE(ForceLimit::create({10, 0, {0, 0, -3, 0, 0, 0}}, Seconds(0.002)));
    EXPECT_FALSE(ForceLimit::create({10, 0, {}}, Seconds(0)));
}

/// A line downwards that meets a spring 60 mm below its start.
TEST(ForceLimit, StopsALineAtAWallWithinTheBrakingDistanceOfTwiceTheLimits) {
    constexpr double speed = 0.25;        // [m/s]
    constexpr double acceleration = 1.2;  // [m/s2]
    constexpr double stiffness = 20e3;    // [N/m]
    for (const std::string robot : {"ur5", "ur5e", "iiwa7", "iiwa14"}) {
        const RobotModel model = loadRobot(robot);
        const Seconds cycle(model.cycleTime());
        LinRequest request;
        request.start = model.home();
        request.reference = TargetReference::relative_base;
        request.target.translation = {0, 0, -0.15};
        request.max_velocity = {speed, speed, speed, 1, 1, 1};
        request.max_acceleration = {acceleration, acceleration, acceleration, 2, 2, 2};
        const Trajectory trajectory = Planner(model).lin(request).value();
        const double surface = trajectory.poseAt(0).translation.z() - 0.06;

        MotionRun execution(trajectory);
        ForceLimit limit = limitOf({kLimit, 0, {}}, cycle.count());
        double tripped_at = 0;
        double depth = 0;
        while (!execution.atRest() || depth == 0) {
            const motion::Pose pose = trajectory.toolPose(execution.next(cycle).position);
            ASSERT_LE(trajectory.deviation(pose).distance, 1e-9);
            depth = surface - pose.translation.z();
            const double force = std::max(0.0, stiffness * depth);
            if (limit.check(along(2, force)) && tripped_at == 0) {
                tripped_at = depth;
                execution.halt();
            }
            ASSERT_FALSE(execution.finished());
        }
        EXPECT_GT(tripped_at, kLimit / stiffness);
        EXPECT_LE(depth - tripped_at, speed * speed / (2 * acceleration) + speed * cycle.count());
    }
}

}  // namespace
}  // namespace metier::motion
