#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "metier/motion/planner.hpp"
#include "metier/motion/stream_follower.hpp"
#include "test_robots.hpp"

namespace metier::motion {
namespace {

constexpr double kCycle = 0.008;
constexpr int kBridge = 3;
constexpr double kJerkFactor = 4;

StreamOptions withoutDelay(double cycle) {
    StreamOptions options;
    options.cycle = Seconds(cycle);
    options.playout_delay_cycles = 0;
    options.extrapolated_cycles = kBridge;
    options.stale_cycles = 1000000;
    options.jerk_factor = kJerkFactor;
    return options;
}

/// Axis 1 of a UR5 at 8 ms; the other axes stand.
class StreamWithoutDelay : public testing::Test {
protected:
    Seconds time(double cycles) const { return Seconds(cycles * kCycle); }

    std::optional<StreamRefusal> send(double angle, double sent, int cycle) {
        JointVector q = model_.home();
        q[0] += angle;
        return follower_.accept(q, time(sent), time(cycle));
    }

    /// One cycle; keeps the largest finite differences of axis 1. \return the angle sent()
    double step(int cycle) {
        const double q = follower_.next(time(cycle)).position[0] - model_.home()[0];
        const double v = (q - last_) / kCycle;
        const double a = (v - velocity_) / kCycle;
        const JointLimits& limits = model_.limits(0);
        worst_ = std::max({worst_, std::abs(v) / limits.velocity, std::abs(a) / limits.acceleration,
                           std::abs(a - acceleration_) / kCycle / limits.jerk / kJerkFactor});
        last_ = q;
        velocity_ = v;
        acceleration_ = a;
        return q;
    }

    /// Up to 1 rad/s within the limits, from cycle 0 on.
    static double ramp(double cycles) {
        const double rise = 0.5;  // [s]
        const double t = cycles * kCycle;
        const double smooth = t - rise / std::numbers::pi * std::sin(std::numbers::pi * t / rise);
        return t < rise ? smooth / 2 : t - rise / 2;
    }

    /// Streams one set-point a cycle until the ramp has its full speed. \return the next cycle
    int rampUp() {
        int cycle = 0;
        for (; cycle < 100; ++cycle) {
            EXPECT_FALSE(send(ramp(cycle), cycle, cycle));
            step(cycle);
        }
        EXPECT_NEAR(velocity_, 1.0, 1e-6);
        return cycle;
    }

    RobotModel model_ = loadRobot("ur5");
    StreamFollower follower_ =
        StreamFollower::create(model_, withoutDelay(kCycle), model_.home()).value();
    double last_ = 0;
    double velocity_ = 0;
    double acceleration_ = 0;
    double worst_ = 0;
};

double sine(double t) {
    return 0.3 * (1 - std::cos(std::numbers::pi * t)) / 2;
}

TEST_F(StreamWithoutDelay, TakesEachSetPointInItsOwnCycle) {
    for (int i = 0; i < 1000; ++i) {
        ASSERT_FALSE(send(sine(i * kCycle), i, i));
        const double q = step(i);
        if (i > 100) {
            ASSERT_NEAR(q, sine(i * kCycle), 1e-6) << i;
        }
    }
    EXPECT_LE(worst_, 1.0);
    EXPECT_EQ(follower_.missedCycles(), 0U);
}

TEST_F(StreamWithoutDelay, GoesOnAtTheLastVelocityWhereNoSetPointCame) {
    std::mt19937_64 random(7);
    int sent = rampUp();
    for (int i = sent; i < 700; ++i) {  // none, or all that are due: none three times at most
        if (random() % 2 == 0 || i - sent >= kBridge) {
            for (; sent <= i; ++sent) {
                ASSERT_FALSE(send(ramp(sent), sent, i));
            }
        }
        ASSERT_NEAR(step(i), ramp(i), 1e-6) << i;
        ASSERT_NEAR(velocity_, 1.0, 1e-3) << i;
    }
    EXPECT_LE(worst_, 1.0);
    EXPECT_EQ(follower_.missedCycles(), 0U);
}

TEST_F(StreamWithoutDelay, StaysNearACurveWhereNoSetPointCame) {
    std::mt19937_64 random(8);
    int sent = 0;
    for (int i = 0; i < 3000; ++i) {
        if (i < 100 || random() % 2 == 0 || i - sent >= kBridge) {
            for (; sent <= i; ++sent) {
                ASSERT_FALSE(send(sine(sent * kCycle), sent, i));
            }
        }
        ASSERT_NEAR(step(i), sine(i * kCycle), 0.005) << i;  // a cycle at 0.47 rad/s: 0.004
    }
    EXPECT_LE(worst_, 1.0);
}

TEST_F(StreamWithoutDelay, DoesNotBrakeForAStreamThatComesLaterFromNowOn) {
    int i = rampUp();
    for (; i < 700; ++i) {  // one cycle later than before, which is at the edge of the cycle
        if (i != 100) {
            ASSERT_FALSE(send(ramp(i - 1), i - 1, i));
        }
        step(i);
        ASSERT_NEAR(velocity_, 1.0, 0.1) << i;
    }
    EXPECT_NEAR(last_, ramp(i - 2), 1e-6) << "the newest";
    EXPECT_LE(worst_, 1.0);
    EXPECT_EQ(follower_.missedCycles(), 0U);
}

TEST_F(StreamWithoutDelay, CatchesUpWithAStreamThatComesEarlierFromNowOn) {
    int i = rampUp();
    for (int sent = i; i < 200; ++i) {
        for (; sent <= i + 1; ++sent) {
            ASSERT_FALSE(send(ramp(sent), sent, i));
        }
        step(i);
        ASSERT_NEAR(velocity_, 1.0, 0.3) << i;
    }
    EXPECT_NEAR(last_, ramp(i), 1e-6) << "the newest";
    EXPECT_LE(worst_, 1.0);
}

TEST_F(StreamWithoutDelay, FollowsASenderWhoseClockGoesAtAnotherSpeed) {
    for (const double speed : {0.997, 1.003}) {  // set-points per cycle
        follower_ = StreamFollower::create(model_, withoutDelay(kCycle), model_.home()).value();
        last_ = velocity_ = acceleration_ = 0;
        int sent = 0;
        for (int i = 0; i < 2000; ++i) {
            for (; sent <= i * speed; ++sent) {
                ASSERT_FALSE(send(sine(sent * kCycle), sent, i));
            }
            const double q = step(i);
            if (i > 100) {  // a cycle at 0.47 rad/s is 0.0038 rad
                ASSERT_NEAR(q, sine(i * speed * kCycle), 0.006) << i << " at " << speed;
            }
        }
        EXPECT_EQ(follower_.missedCycles(), 0U);
    }
    EXPECT_LE(worst_, 1.0);
}

TEST_F(StreamWithoutDelay, FollowsASenderOfALowerRate) {
    const auto wave = [](double cycles) { return sine(cycles * kCycle / 2); };
    for (int i = 0; i < 2000; ++i) {
        if (i % 3 == 0) {
            ASSERT_FALSE(send(wave(i), i, i));
        }
        ASSERT_NEAR(step(i), wave(i), 2e-3) << i;
    }
    EXPECT_LE(worst_, 1.0);
    EXPECT_EQ(follower_.missedCycles(), 0U);
}

TEST_F(StreamWithoutDelay, BrakesWithinTheLimitsWhenTheStreamFallsSilent) {
    const int silent = rampUp();
    int i = silent;
    for (; i < silent + kBridge; ++i) {
        step(i);
        EXPECT_NEAR(velocity_, 1.0, 1e-6);
    }
    EXPECT_EQ(follower_.missedCycles(), 0U);
    while (!follower_.atRest() && i < silent + 1000) {
        step(i++);
    }
    const JointLimits& limits = model_.limits(0);
    const double braking =
        1.0 / limits.acceleration + limits.acceleration / (kJerkFactor * limits.jerk);
    EXPECT_LE((i - silent - kBridge - 3) * kCycle, braking);
    EXPECT_GT(follower_.missedCycles(), 0U);
    EXPECT_LE(worst_, 1.0);
}

TEST_F(StreamWithoutDelay, GoesOnWithAStreamThatComesBack) {
    int i = rampUp();
    for (; i < 130; ++i) {
        step(i);
    }
    for (; i < 500; ++i) {
        ASSERT_FALSE(send(ramp(i), i, i));
        step(i);
    }
    EXPECT_NEAR(last_, ramp(i - 1), 1e-6);
    EXPECT_LE(worst_, 1.0);
}

TEST_F(StreamWithoutDelay, HoldsExactlyTheLastSetPointOfAStreamThatStands) {
    const double far = 1.5 * model_.limits(0).velocity * kCycle;  // cannot be reached in a cycle
    ASSERT_FALSE(send(0, 0, 0));
    step(0);
    ASSERT_FALSE(send(far, 1, 1));
    step(1);
    ASSERT_FALSE(send(far, 2, 2));
    for (int i = 2; i < 300; ++i) {
        step(i);
    }
    EXPECT_NEAR(last_, far, 1e-12);
    for (int i = 300; i < 320; ++i) {
        EXPECT_EQ(step(i), last_);
    }
    EXPECT_EQ(follower_.missedCycles(), 0U);
    EXPECT_LE(worst_, 1.0);
}

TEST_F(StreamWithoutDelay, GoesToASingleSetPointAndNoFurther) {
    const double near = 0.8 * model_.limits(0).velocity * kCycle;
    ASSERT_FALSE(send(near, 0, 0));
    for (int i = 0; i < 300; ++i) {
        ASSERT_LE(step(i), near + 2e-4);
    }
    EXPECT_NEAR(last_, near, 1e-6);
    EXPECT_LE(worst_, 1.0);
}

TEST_F(StreamWithoutDelay, ComesToRestAtTheLastSetPointOfAStreamThatBrakesAndEnds) {
    for (int i = 0; i <= 125; ++i) {  // the sine stands at 125
        ASSERT_FALSE(send(sine(i * kCycle), i, i));
        step(i);
    }
    ASSERT_FALSE(send(sine(125 * kCycle), 126, 126));
    for (int i = 126; i < 200; ++i) {
        step(i);
    }
    EXPECT_NEAR(last_, 0.3, 1e-9);
    EXPECT_LE(worst_, 1.0);
}

using WhiteNoiseOf = EachRobot;
INSTANTIATE_TEST_SUITE_P(Robots, WhiteNoiseOf, testing::ValuesIn(kRobots), robotName);

/// Set-points anywhere that is accepted, none to three in a cycle, sometimes a long silence.
TEST_P(WhiteNoiseOf, WithoutDelayBreaksNoLimit) {
    const double cycle = model_.cycleTime();
    auto follower = StreamFollower::create(model_, withoutDelay(cycle), model_.home()).value();
    std::mt19937_64 random(9);
    std::uniform_real_distribution<double> unit(-1, 1);
    const double rounding = 1e-8 / (cycle * cycle * cycle);  // 1e-8 rad at the end of a range
    std::array<JointVector, 4> q;
    q.fill(model_.home());
    JointVector target = model_.home();
    double time = 0;
    int silent = 0;
    int accepted = 0;
    for (int i = 0; i < 20000; ++i) {
        silent = silent > 0 ? silent - 1 : (random() % 200 == 0 ? 60 : 0);
        for (auto left = silent > 0 ? 0 : random() % 4; left > 0; --left) {
            const double step = cycle * (0.5 + std::abs(unit(random)));
            JointVector wild = target;
            for (std::size_t axis = 0; axis < wild.size(); ++axis) {
                const JointLimits& limits = model_.limits(axis);
                wild[axis] = std::clamp(wild[axis] + 1.9 * step * limits.velocity * unit(random),
                                        limits.lower, limits.upper);
            }
            time += step;
            if (!follower.accept(wild, Seconds(time), Seconds(i * cycle))) {
                target = wild;
                ++accepted;
            }
        }
        std::copy_backward(q.begin(), q.end() - 1, q.end());
        q[0] = follower.next(Seconds(i * cycle)).position;
        for (std::size_t axis = 0; axis < target.size(); ++axis) {
            const JointLimits& limits = model_.limits(axis);
            ASSERT_GE(q[0][axis] - limits.lower, 0)
                << i << " axis " << axis << " silent " << silent;
            ASSERT_LE(q[0][axis] - limits.upper, 0)
                << i << " axis " << axis << " silent " << silent;
        }
        for (std::size_t axis = 0; axis < target.size(); ++axis) {
            const JointLimits& limits = model_.limits(axis);
            const double v = (q[0][axis] - q[1][axis]) / cycle;
            const double a = (q[0][axis] - 2 * q[1][axis] + q[2][axis]) / (cycle * cycle);
            const double j = (q[0][axis] - 3 * q[1][axis] + 3 * q[2][axis] - q[3][axis]) /
                             (cycle * cycle * cycle);
            ASSERT_LE(std::abs(v) / limits.velocity, 1 + 2e-6)
                << i << " axis " << axis << " silent " << silent;
            ASSERT_LE(std::abs(a), limits.acceleration * (1 + 1e-6)) << i;
            ASSERT_LE(std::abs(j), kJerkFactor * limits.jerk * (1 + 1e-5) + rounding) << i;
        }
    }
    EXPECT_GT(accepted, 20000);
    EXPECT_GT(follower.missedCycles(), 1000U);
}

using FullLimitsWithoutDelayOf = EachRobot;
INSTANTIATE_TEST_SUITE_P(Robots, FullLimitsWithoutDelayOf, testing::ValuesIn(kRobots), robotName);

TEST_P(FullLimitsWithoutDelayOf, AreFollowedInTheSameCycle) {
    const double cycle = model_.cycleTime();
    auto follower = StreamFollower::create(model_, withoutDelay(cycle), model_.home()).value();
    PtpRequest request;
    request.start = model_.home();
    JointVector target = model_.home();
    target[0] += 1.5;
    target[1] -= 0.3;
    target[3] += 0.7;
    request.target = target;
    const Trajectory plan = Planner(model_).ptp(request).value();
    std::array<JointVector, 4> last;
    last.fill(model_.home());
    for (int i = 0; i * cycle < plan.duration().count() + 10 * cycle; ++i) {
        const Seconds now(i * cycle);
        ASSERT_FALSE(follower.accept(plan.sample(now).position, now, now));
        std::copy_backward(last.begin(), last.end() - 1, last.end());
        last[0] = follower.next(now).position;
        ASSERT_LT(maxDifference(last[0], plan.sample(now).position), 2e-6) << i;
        for (std::size_t axis = 0; axis < target.size(); ++axis) {
            const double j = last[0][axis] - 3 * last[1][axis] + 3 * last[2][axis] - last[3][axis];
            ASSERT_LE(std::abs(j) / (cycle * cycle * cycle),
                      model_.limits(axis).jerk * (1 + 2e-6) + 1e-15 / (cycle * cycle * cycle));
        }
    }
    EXPECT_LE(maxDifference(last[0], target), 1e-9);
}

}  // namespace
}  // namespace metier::motion
