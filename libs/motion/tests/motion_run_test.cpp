#include "metier/motion/motion_run.hpp"

#include <gtest/gtest.h>

#include <random>

#include "metier/motion/planner.hpp"
#include "test_robots.hpp"

namespace metier::motion {
namespace {

constexpr Seconds kCycle{0.008};

Trajectory lineOf(const RobotModel& model, double length) {
    LinRequest request;
    request.start = model.home();
    request.reference = TargetReference::relative_base;
    request.target.translation = {0, 0, length};
    request.max_velocity = {0.25, 0.25, 0.25, 1, 1, 1};
    request.max_acceleration = {1.2, 1.2, 1.2, 2, 2, 2};
    return Planner(model).lin(request).value();
}

using ExecutionOf = EachRobot;
INSTANTIATE_TEST_SUITE_P(Robots, ExecutionOf, testing::ValuesIn(kRobots), robotName);

TEST_P(ExecutionOf, RunsTheTrajectoryAsPlanned) {
    const Trajectory trajectory = lineOf(model_, 0.1);
    MotionRun execution(trajectory);
    EXPECT_EQ(execution.current().position, trajectory.start());
    for (int i = 1; !execution.finished(); ++i) {
        ASSERT_LE(
            maxDifference(execution.next(kCycle).position, trajectory.sample(i * kCycle).position),
            1e-9);
        ASSERT_LT(i, 10000);
    }
    EXPECT_EQ(execution.current().position, trajectory.end());
    EXPECT_EQ(execution.pathParameter(), 1.0);
}

TEST_P(ExecutionOf, SuspendsAndResumesAnywhereOnThePath) {
    std::mt19937_64 random(1);
    const Trajectory trajectory = lineOf(model_, 0.1);
    std::uniform_int_distribution<int> when(0, static_cast<int>(trajectory.duration() / kCycle));
    for (int run = 0; run < scaled(1000); ++run) {
        MotionRun execution(trajectory);
        const int stop_at = when(random);
        for (int i = 0; i < stop_at; ++i) {
            execution.next(kCycle);
        }
        execution.stop();
        while (!execution.atRest()) {
            const auto point = execution.next(kCycle);
            ASSERT_LE(trajectory.deviation(trajectory.toolPose(point.position)).distance, 1e-9);
        }
        const JointVector held = execution.current().position;
        EXPECT_EQ(execution.next(kCycle).position, held);
        EXPECT_TRUE(execution.current().velocity.allZero());
        execution.resume();
        for (int i = 0; !execution.finished() && i < 10000; ++i) {
            const auto point = execution.next(kCycle);
            ASSERT_LE(trajectory.deviation(trajectory.toolPose(point.position)).distance, 1e-9);
        }
        ASSERT_TRUE(execution.finished());
        EXPECT_EQ(execution.current().position, trajectory.end());
    }
}

TEST(MotionRun, StopsFromAQuarterOfAMetrePerSecondWithinThreeTenthsOfASecond) {
    const RobotModel model = loadRobot("ur5");
    const Trajectory trajectory = lineOf(model, 0.2);
    MotionRun execution(trajectory);
    while (execution.pathParameter() < 0.5) {
        execution.next(kCycle);
    }
    const double before = execution.pathParameter();
    execution.stop();
    EXPECT_LE(execution.remaining().count(), 0.3);
    const double full = execution.remaining().count();
    execution.halt();
    EXPECT_LT(execution.remaining().count(), 0.65 * full);
    while (!execution.atRest()) {
        execution.next(kCycle);
    }
    EXPECT_LT((execution.pathParameter() - before) * 0.2, 0.036);
    EXPECT_FALSE(execution.finished());
}

TEST(MotionRun, BrakesWithTheFirstSetPointAfterAStopOrHalt) {
    const RobotModel model = loadRobot("ur5");
    const Trajectory trajectory = lineOf(model, 0.2);
    for (const auto brake : {&MotionRun::stop, &MotionRun::halt}) {
        MotionRun execution(trajectory);
        while (execution.pathParameter() < 0.5) {
            execution.next(kCycle);
        }
        const double before = execution.pathParameter();
        execution.next(kCycle);
        const double step = execution.pathParameter() - before;
        const double at = execution.pathParameter();
        (execution.*brake)();
        execution.next(kCycle);
        EXPECT_LT(execution.pathParameter() - at, 0.9999 * step);
    }
}

/// A motion of some seconds that brakes for a stop in a given time.
class StopInATime : public ::testing::Test {
protected:
    StopInATime() {
        while (execution_.pathParameter() < 0.4) {
            execution_.next(kCycle);
        }
        execution_.stopIn(kLength);
    }
    Seconds untilRest() {
        Seconds time{0};
        for (; !execution_.atRest(); time += kCycle) {
            const auto point = execution_.next(kCycle);
            EXPECT_LE(trajectory_.deviation(trajectory_.toolPose(point.position)).distance, 1e-9);
        }
        return time;
    }

    static constexpr Seconds kLength{0.8};
    const RobotModel model_ = loadRobot("ur5");
    const Trajectory trajectory_ = lineOf(model_, 0.4);
    MotionRun execution_{trajectory_};
};

TEST_F(StopInATime, TakesJustThatTimeOnThePath) {
    EXPECT_EQ(execution_.remaining(), kLength);
    EXPECT_NEAR(untilRest().count(), kLength.count(), kCycle.count());
    EXPECT_TRUE(execution_.current().velocity.allZero());
    const auto held = execution_.current().position;
    EXPECT_EQ(execution_.next(kCycle).position, held);
    EXPECT_FALSE(execution_.finished());
}

TEST_F(StopInATime, IsNoReasonForAHaltToTakeLonger) {
    MotionRun at_once(trajectory_);
    while (at_once.pathParameter() < execution_.pathParameter()) {
        at_once.next(kCycle);
    }
    at_once.halt();
    for (int i = 0; i < 10; ++i) {
        execution_.next(kCycle);
    }
    execution_.halt();
    EXPECT_LE(execution_.remaining().count(), 1.05 * at_once.remaining().count());
    EXPECT_LE(untilRest().count(), 1.05 * at_once.remaining().count() + kCycle.count());
}

TEST_F(StopInATime, IsOverWithAResumeAlsoWhileItBrakes) {
    execution_.next(kLength / 2);
    execution_.resume();
    untilRest();
    EXPECT_TRUE(execution_.finished());
    EXPECT_EQ(execution_.current().position, trajectory_.end());
}

TEST_F(StopInATime, FollowsAHaltAndAResume) {
    execution_.halt();
    untilRest();
    execution_.resume();
    while (execution_.pathParameter() < 0.6) {
        execution_.next(kCycle);
    }
    execution_.stopIn(kLength / 2);
    EXPECT_NEAR(untilRest().count(), kLength.count() / 2, kCycle.count());
    EXPECT_FALSE(execution_.finished());
}

TEST(MotionRun, OverrideChangesTheSpeedButNotThePath) {
    const RobotModel model = loadRobot("ur5");
    const Trajectory trajectory = lineOf(model, 0.2);
    MotionRun execution(trajectory);
    std::mt19937_64 random(2);
    std::uniform_real_distribution<double> factor(0.05, 1.0);
    int cycles = 0;
    while (!execution.finished() && cycles < 10000) {
        if (++cycles % 20 == 0) {
            execution.setOverride(factor(random));
        }
        const auto point = execution.next(kCycle);
        ASSERT_LE(trajectory.deviation(trajectory.toolPose(point.position)).distance, 1e-9);
    }
    EXPECT_TRUE(execution.finished());
    EXPECT_GT(cycles * kCycle.count(), trajectory.duration().count());
}

TEST(MotionRun, OverrideOfZeroStandsOnThePathUntilItIsRaised) {
    const RobotModel model = loadRobot("ur5");
    const Trajectory trajectory = lineOf(model, 0.1);
    MotionRun execution(trajectory);
    for (int i = 0; i < 20; ++i) {
        execution.next(kCycle);
    }
    execution.setOverride(0);
    while (!execution.atRest()) {
        execution.next(kCycle);
    }
    EXPECT_FALSE(execution.finished());
    execution.setOverride(1);
    for (int i = 0; !execution.finished() && i < 1000; ++i) {
        execution.next(kCycle);
    }
    EXPECT_TRUE(execution.finished());
}

TEST(MotionRun, ALateCycleStaysOnTheTimeBase) {
    const RobotModel model = loadRobot("ur5");
    const Trajectory trajectory = lineOf(model, 0.1);
    MotionRun execution(trajectory);
    execution.next(kCycle);
    execution.next(3 * kCycle);
    EXPECT_LE(maxDifference(execution.current().position, trajectory.sample(4 * kCycle).position),
              1e-12);
}

class LateCycle : public testing::Test {
protected:
    LateCycle() {
        while (execution_.pathParameter() < 0.4) {
            execution_.next(kCycle);
        }
    }

    /// Distance of the tool from where it was [m].
    double step(Seconds step) {
        const JointVector before = execution_.current().position;
        const JointVector after = execution_.next(step).position;
        return motion::distanceBetween(trajectory_.toolPose(before), trajectory_.toolPose(after));
    }

    static constexpr int kMostSkipped = 3;
    RobotModel model_ = loadRobot("ur5");
    Trajectory trajectory_ = lineOf(model_, 0.2);
    MotionRun execution_{trajectory_, {kCycle, kMostSkipped}};
};

TEST_F(LateCycle, GoesOnOnTheTimeBaseIfNoMoreCyclesAreSkippedThanAllowed) {
    EXPECT_NEAR(step((kMostSkipped + 1) * kCycle), 0.25 * (kMostSkipped + 1) * 0.008, 1e-6);
    EXPECT_FALSE(execution_.stoppedLate());
    EXPECT_NEAR(step(kCycle), 0.25 * 0.008, 1e-6);
}

TEST_F(LateCycle, StopsOnThePathIfMoreAreSkipped) {
    EXPECT_LE(step((kMostSkipped + 2) * kCycle), 0.25 * 0.008 + 1e-6) << "one cycle on, no leap";
    EXPECT_TRUE(execution_.stoppedLate());
    int cycles = 0;
    while (!execution_.atRest()) {
        execution_.next(kCycle);
        const auto pose = trajectory_.toolPose(execution_.current().position);
        ASSERT_LE(trajectory_.deviation(pose).distance, 1e-9);
        ASSERT_LT(++cycles * kCycle.count(), 0.3);
    }
    EXPECT_FALSE(execution_.finished());
    EXPECT_LT(execution_.pathParameter(), 0.6);
    execution_.resume();
    EXPECT_FALSE(execution_.stoppedLate());
    while (!execution_.finished()) {
        execution_.next(kCycle);
    }
}

TEST_F(LateCycle, WhileBrakingDoesNotLeapEither) {
    execution_.stop();
    EXPECT_LE(step(20 * kCycle), 0.25 * 0.008 + 1e-6);
    EXPECT_FALSE(execution_.stoppedLate());
    EXPECT_FALSE(execution_.atRest());
}

TEST_F(LateCycle, AtRestMeansNothing) {
    execution_.stop();
    while (!execution_.atRest()) {
        execution_.next(kCycle);
    }
    EXPECT_EQ(step(100 * kCycle), 0.0);
    EXPECT_FALSE(execution_.stoppedLate());
}

TEST(MotionRun, AMotionOfNoLengthIsFinishedAtOnce) {
    const RobotModel model = loadRobot("ur5");
    MotionRun execution(lineOf(model, 0.0));
    execution.next(kCycle);
    EXPECT_TRUE(execution.finished());
    EXPECT_EQ(execution.current().position, model.home());
}

}  // namespace
}  // namespace metier::motion
