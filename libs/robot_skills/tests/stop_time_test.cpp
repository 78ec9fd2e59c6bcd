#include "moves/stop_time.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "bench.hpp"
#include "conversions.hpp"
#include "metier/motion/motion_run.hpp"
#include "metier/robot_skills/move_planning.hpp"

namespace metier::robot_skills {
namespace {

using motion::Seconds;
using motion::Trajectory;
using skill::State;
using skill::ValueMap;

/// Turns every axis by up to 1.2 rad.
JointMoveParameters randomTurn(std::mt19937& random, std::size_t axes) {
    std::uniform_real_distribution<double> turn(-1.2, 1.2);
    JointMoveParameters parameters;
    parameters.relative = static_cast<std::int32_t>(Relative::base);
    for (std::size_t axis = 0; axis < axes; ++axis) {
        parameters.target_joint_position.push_back(turn(random));
    }
    return parameters;
}

/// Time from the last moment at which the motion is about as fast as ever to its end [s].
double brakingOf(const Trajectory& trajectory) {
    constexpr int count = 50;
    std::vector<double> speeds;
    for (int i = 0; i < count; ++i) {
        speeds.push_back(
            trajectory.sample(trajectory.duration() * i / count).velocity.view().norm());
    }
    const double largest = *std::max_element(speeds.begin(), speeds.end());
    const auto last = std::find_if(speeds.rbegin(), speeds.rend(),
                                   [&](double speed) { return speed >= 0.95 * largest; });
    return trajectory.duration().count() * static_cast<double>(last - speeds.rbegin() + 1) / count;
}

/// As a component of several arms asks for it, of a motion that it has slowed down [s].
double commonStop(const Trajectory& quickest, double slowed) {
    return brakingOf(quickest) * (1.15 / std::sqrt(slowed) + std::exp(-10.0 * (slowed - 1.0)));
}

/// The planned time at which the motion is where an arm stands now [s].
double plannedTimeOf(const Trajectory& trajectory, const motion::JointVector& now) {
    const auto gone = [&](const motion::JointVector& q) {
        return (q.view() - trajectory.start().view()).norm();
    };
    double low = 0.0;
    double high = trajectory.duration().count();
    for (int i = 0; i < 60; ++i) {
        const double middle = (low + high) / 2;
        (gone(trajectory.sample(Seconds(middle)).position) < gone(now) ? low : high) = middle;
    }
    return high;
}

TEST(StopTime, IsTakenByArmsOfAllKindsFromAnySpeed) {
    std::mt19937 random(5);
    for (const auto* robot : {"iiwa7", "ur5", "edo"}) {
        const auto model = modelOf(robot);
        for (int i = 0; i < 40; ++i) {
            const auto plan =
                planJointPtp(model, model.home(), randomTurn(random, model.axisCount()));
            if (!plan) {
                continue;
            }
            for (const double slowed : {1.0, 1.05, 1.1, 1.2, 1.3, 1.5, 2.0, 3.0, 10.0, 30.0}) {
                const double asked = commonStop(*plan, slowed);
                EXPECT_EQ(stopTimeFor(plan->stretchedTo(slowed * plan->duration()), model, asked),
                          asked)
                    << robot << " slowed down by " << slowed;
            }
        }
    }
}

TEST(StopTime, IsLongerWhereAnAxisWouldNeedTooMuchForIt) {
    const auto model = modelOf("ur5");
    JointMoveParameters parameters;
    parameters.relative = static_cast<std::int32_t>(Relative::base);
    parameters.target_joint_position = {1.0, 0, 0, 0, 0, 0};
    const auto plan = planJointPtp(model, model.home(), parameters);
    ASSERT_TRUE(plan);
    const double length = stopTimeFor(*plan, model, 0.01);
    EXPECT_GT(length, 0.1);
    EXPECT_LT(length, 2 * plan->duration().count());
    motion::MotionRun execution(*plan);
    execution.next(plan->duration() / 2);
    execution.stopIn(Seconds(length));
    while (!execution.atRest()) {
        const auto point = execution.next(Seconds(0.001));
        EXPECT_LE(std::abs(point.acceleration[0]), 1.25 * model.limits(0).acceleration);
    }
}

TEST(StopTime, OfNothingAskedIsNone) {
    const auto model = modelOf("ur5");
    std::mt19937 random(3);
    const auto plan = planJointPtp(model, model.home(), randomTurn(random, 6));
    ASSERT_TRUE(plan);
    EXPECT_EQ(stopTimeFor(*plan, model, {}), 0.0);
    EXPECT_EQ(stopTimeFor(*plan, model, 0.0), 0.0);
}

/// An arm in a motion of several together; its cycle is its own.
class TogetherMoving {
public:
    TogetherMoving(const std::string& robot, std::mt19937& random) : bench_(robot) {
        while (!plan_) {
            turn_ = randomTurn(random, bench_.model().axisCount());
            if (auto plan = planJointPtp(bench_.model(), bench_.commanded(), turn_)) {
                plan_.emplace(std::move(*plan));
            }
        }
    }
    const Trajectory& plan() const { return *plan_; }
    void start(double duration, double stop_time) {
        ASSERT_TRUE(bench_.start(kJointPtp, {{"TargetJointPosition", turn_.target_joint_position},
                                             {"Relative", turn_.relative},
                                             {"Duration", duration},
                                             {"StopTime", stop_time}}));
        plan_ = plan_->stretchedTo(Seconds(duration));
    }
    /// \return the planned time at which it stands [s]
    double suspendedAt(double time) {
        const double cycle = bench_.arm().info().cycleSeconds();
        bench_.steps(static_cast<int>(std::lround(time / cycle)));
        EXPECT_TRUE(bench_.program(kJointPtp).suspend(bench_.caller()));
        EXPECT_TRUE(bench_.stepUntil(kJointPtp, State::suspended));
        return plannedTimeOf(*plan_, bench_.commanded());
    }

private:
    Bench bench_;
    JointMoveParameters turn_;
    std::optional<Trajectory> plan_;
};

TEST(StopTime, HasTwoArmsOfOtherLimitsAndCyclesStandAtOneTimeOfTheirPlans) {
    std::mt19937 random(11);
    for (const double duration : {0.0, 4.0, 20.0}) {
        for (const double share : {0.15, 0.5, 0.7}) {
            TogetherMoving left("iiwa7", random);
            TogetherMoving right("edo", random);
            double common = duration;
            for (const auto* arm : {&left, &right}) {
                common = std::max(common, arm->plan().duration().count());
            }
            double stop = 0.0;
            for (const auto* arm : {&left, &right}) {
                stop = std::max(stop,
                                commonStop(arm->plan(), common / arm->plan().duration().count()));
            }
            left.start(common, stop);
            right.start(common, stop);
            EXPECT_NEAR(left.suspendedAt(share * common), right.suspendedAt(share * common), 0.020)
                << "of " << common << " s, stop " << stop << " s";
        }
    }
}

}  // namespace
}  // namespace metier::robot_skills
