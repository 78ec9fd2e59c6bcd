#include "metier/motion/stream_follower.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

#include "metier/motion/planner.hpp"
#include "test_robots.hpp"

namespace metier::motion {
namespace {

using testing::HasSubstr;

constexpr double kCycle = 0.008;

class StreamFollowerTest : public testing::Test {
protected:
    StreamFollowerTest()
        : follower_(StreamFollower::create(model_, {Seconds(kCycle)}, model_.home()).value()) {}

    Seconds time(int cycle) const { return Seconds(cycle * kCycle); }

    /// One cycle; keeps the largest finite differences.
    JointVector step(int cycle) {
        const JointVector q = follower_.next(time(cycle)).position;
        for (std::size_t i = 0; i < q.size(); ++i) {
            const double v = (q[i] - last_[i]) / kCycle;
            const double a = (v - velocity_[i]) / kCycle;
            const double j = (a - acceleration_[i]) / kCycle;
            const JointLimits& limits = model_.limits(i);
            worst_ = std::max({worst_, std::abs(v) / limits.velocity,
                               std::abs(a) / limits.acceleration, std::abs(j) / limits.jerk});
            velocity_[i] = v;
            acceleration_[i] = a;
        }
        last_ = q;
        return q;
    }

    JointVector offset(double angle) const {
        JointVector q = model_.home();
        q[0] += angle;
        return q;
    }

    RobotModel model_ = loadRobot("ur5");
    StreamFollower follower_;
    JointVector last_ = model_.home();
    JointVector velocity_ = JointVector(6);
    JointVector acceleration_ = JointVector(6);
    double worst_ = 0;
};

TEST_F(StreamFollowerTest, HoldsUntilTheFirstSetPoint) {
    for (int i = 0; i < 10; ++i) {
        EXPECT_EQ(step(i), model_.home());
    }
    EXPECT_EQ(follower_.state(), StreamFollower::State::waiting);
    EXPECT_EQ(follower_.missedCycles(), 0U);
}

TEST_F(StreamFollowerTest, FollowsASineExactlyAfterThePlayoutDelay) {
    const auto sine = [](double t) { return 0.3 * (1 - std::cos(std::numbers::pi * t)) / 2; };
    double worst = 0;
    for (int i = 0; i < 1000; ++i) {
        ASSERT_FALSE(follower_.accept(offset(sine(i * kCycle)), time(i), time(i)));
        const JointVector q = step(i);
        if (i > 100) {
            worst = std::max(worst, std::abs(q[0] - model_.home()[0] - sine((i - 3) * kCycle)));
        }
    }
    EXPECT_LT(worst, 1e-6);
    EXPECT_LE(worst_, 1.0);
    EXPECT_EQ(follower_.missedCycles(), 0U);
}

TEST_F(StreamFollowerTest, BreaksNoLimitForWhiteNoise) {
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> unit(-1, 1);
    JointVector q = model_.home();
    int accepted = 0;
    for (int i = 0; i < 20000; ++i) {
        JointVector wild = q;
        for (std::size_t axis = 0; axis < q.size(); ++axis) {
            wild[axis] += 1.9 * kCycle * model_.limits(axis).velocity * unit(random);
            wild[axis] =
                std::clamp(wild[axis], model_.limits(axis).lower, model_.limits(axis).upper);
        }
        if (!follower_.accept(wild, time(i), time(i))) {
            q = wild;
            ++accepted;
        }
        ASSERT_TRUE(model_.kinematics().withinLimits(step(i))) << i;
        ASSERT_LE(worst_, 1.0) << i;
    }
    EXPECT_GT(accepted, 19000);
}

TEST_F(StreamFollowerTest, UsesMoreThanTheAccelerationLimitOnlyToBrake) {
    const StreamOptions options{.cycle = Seconds(kCycle), .jerk_factor = 4, .braking_factor = 2};
    follower_ = StreamFollower::create(model_, options, model_.home()).value();
    std::mt19937_64 random(4);
    std::uniform_real_distribution<double> unit(-1, 1);
    JointVector q = model_.home();
    double hardest = 0;
    for (int i = 0; i < 20000; ++i) {
        JointVector wild = q;
        for (std::size_t axis = 0; axis < q.size(); ++axis) {
            wild[axis] += 1.9 * kCycle * model_.limits(axis).velocity * unit(random);
        }
        if (!follower_.accept(wild, time(i), time(i))) {
            q = wild;
        }
        ASSERT_TRUE(model_.kinematics().withinLimits(step(i))) << i;
        for (std::size_t axis = 0; axis < q.size(); ++axis) {
            const double used = std::abs(acceleration_[axis]) / model_.limits(axis).acceleration;
            ASSERT_LE(used, acceleration_[axis] * velocity_[axis] > 1e-6 ? 1 + 1e-5 : 2 + 1e-5)
                << "cycle " << i << ", axis " << axis + 1;
            hardest = std::max(hardest, used);
        }
    }
    EXPECT_GT(hardest, 1.5);
}

using FullLimitStreamOf = EachRobot;
INSTANTIATE_TEST_SUITE_P(Robots, FullLimitStreamOf, testing::ValuesIn(kRobots), robotName);

TEST_P(FullLimitStreamOf, IsFollowedWithoutOvershootAndWithoutMoreJerkThanItsOwn) {
    const double cycle = model_.cycleTime();
    StreamFollower follower =
        StreamFollower::create(model_, {Seconds(cycle)}, model_.home()).value();
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
    double off = 0;
    double jerk = 0;
    for (int i = 0; i * cycle < plan.duration().count() + 10 * cycle; ++i) {
        const Seconds now(i * cycle);
        ASSERT_FALSE(follower.accept(plan.sample(now).position, now, now));
        std::copy_backward(last.begin(), last.end() - 1, last.end());
        last[0] = follower.next(now).position;
        off = std::max(off, maxDifference(last[0], plan.sample(Seconds((i - 3) * cycle)).position));
        for (std::size_t axis = 0; axis < target.size(); ++axis) {
            const double j = last[0][axis] - 3 * last[1][axis] + 3 * last[2][axis] - last[3][axis];
            jerk = std::max(jerk, std::abs(j) / (cycle * cycle * cycle) / model_.limits(axis).jerk);
        }
    }
    EXPECT_LT(off, 2e-6);  // error at the start, when no further set-point is known yet
    EXPECT_LE(jerk, 1 + 2e-6);
    EXPECT_LE(maxDifference(last[0], target), 1e-9);
}

TEST_F(StreamFollowerTest, CatchesUpWithAStreamThatWasTooFast) {
    for (int i = 0; i < 600; ++i) {
        const double angle = std::min(i * kCycle * 3.0, 1.5);  // from rest to 3 rad/s at once
        ASSERT_FALSE(follower_.accept(offset(angle), time(i), time(i)));
        step(i);
    }
    EXPECT_NEAR(last_[0], model_.home()[0] + 1.5, 1e-6);
    EXPECT_LE(worst_, 1.0);
}

TEST_F(StreamFollowerTest, RefusesAJumpWithAxisValueAndLimit) {
    const auto refusal = follower_.accept(offset(1.0), time(0), time(0));
    ASSERT_TRUE(refusal);
    EXPECT_EQ(refusal->reason, StreamRefusal::Reason::jump);
    EXPECT_EQ(toError(*refusal).code, Errc::out_of_range);
    EXPECT_THAT(toError(*refusal).message, HasSubstr("axis 1: jump of 1.0000 rad over limit"));
    EXPECT_EQ(step(0), model_.home());
}

TEST_F(StreamFollowerTest, RefusesWrongSizesWhatIsNotFiniteAndOldTimes) {
    using Reason = StreamRefusal::Reason;
    EXPECT_EQ(follower_.accept(JointVector(7), time(0), time(0))->reason, Reason::wrong_size);
    EXPECT_EQ(follower_.accept(offset(std::nan("")), time(0), time(0))->reason, Reason::not_finite);
    EXPECT_EQ(follower_.accept(JointVector::constant(6, 9.0), time(0), time(0))->reason,
              Reason::position_limit);
    ASSERT_FALSE(follower_.accept(offset(0), time(1), time(1)));
    EXPECT_EQ(follower_.accept(offset(0), time(1), time(2))->reason, Reason::not_later);
}

TEST_F(StreamFollowerTest, StopsWithinTheLimitsWhenTheStreamFallsSilent) {
    int i = 0;
    for (; i < 300; ++i) {
        const double t = i * kCycle;
        const double angle = t < 1 ? 0.5 * t * t : 0.5 + (t - 1);  // up to 1 rad/s
        ASSERT_FALSE(follower_.accept(offset(angle), time(i), time(i)));
        step(i);
    }
    const int silent = i;
    while (follower_.state() != StreamFollower::State::timed_out && i < silent + 1000) {
        step(i++);
    }
    EXPECT_EQ(follower_.state(), StreamFollower::State::timed_out);
    EXPECT_LE(worst_, 1.0);
    // After the playout delay and the first missed cycle: v/a + a/j with the limits of axis 1.
    EXPECT_LE((i - silent) * kCycle, (3 + 1 + 2) * kCycle + 1.0 / 5 + 5.0 / 50);
    EXPECT_GT(follower_.missedCycles(), 0U);
    EXPECT_EQ(follower_.accept(offset(0), time(i), time(i))->reason,
              StreamRefusal::Reason::timed_out);
}

TEST_F(StreamFollowerTest, SmoothsIrregularArrival) {
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> jitter(0, 1.5 * kCycle);
    const auto sine = [](double t) { return 0.3 * (1 - std::cos(std::numbers::pi * t)) / 2; };
    std::vector<double> arrival;
    for (int i = 0; i < 600; ++i) {
        const double at = i * kCycle + (i == 0 ? 0.0 : jitter(random));
        arrival.push_back(arrival.empty() ? at : std::max(at, arrival.back()));
    }
    std::size_t sent = 0;
    for (int i = 0; i < 590; ++i) {
        for (; sent < arrival.size() && arrival[sent] <= i * kCycle; ++sent) {
            const double t = static_cast<double>(sent) * kCycle;
            ASSERT_FALSE(follower_.accept(offset(sine(t)), Seconds(t), time(i)));
        }
        const JointVector q = step(i);
        if (i > 100) {
            EXPECT_NEAR(q[0] - model_.home()[0], sine((i - 3) * kCycle), 1e-5);
        }
    }
    EXPECT_LE(worst_, 1.0);
    EXPECT_EQ(follower_.missedCycles(), 0U);
}

TEST_F(StreamFollowerTest, RefusesOptionsThatMakeNoSense) {
    EXPECT_FALSE(StreamFollower::create(model_, {Seconds(0)}, model_.home()));
    EXPECT_FALSE(StreamFollower::create(model_, {Seconds(0.01), -1}, model_.home()));
    EXPECT_FALSE(StreamFollower::create(model_, {Seconds(0.01)}, JointVector(7)));
    EXPECT_FALSE(StreamFollower::create(model_, {.cycle = Seconds(0.01), .braking_factor = 0.9},
                                        model_.home()));
}

// A set-point without a time in the stream would make every later position not a number.
TEST_F(StreamFollowerTest, RefusesATimeThatIsNotFinite) {
    using Reason = StreamRefusal::Reason;
    const std::array times{std::nan(""), std::numeric_limits<double>::infinity(),
                           -std::numeric_limits<double>::infinity()};
    for (const double t : times) {
        const auto refusal = follower_.accept(offset(0), Seconds(t), time(0));
        ASSERT_TRUE(refusal) << t;
        EXPECT_EQ(refusal->reason, Reason::not_later);
    }
    EXPECT_EQ(follower_.state(), StreamFollower::State::waiting);
    ASSERT_FALSE(follower_.accept(offset(0), time(0), time(0)));
    for (const double t : times) {
        EXPECT_EQ(follower_.accept(offset(0.1), Seconds(t), time(1))->reason, Reason::not_later)
            << t;
    }
    for (int i = 1; i < 20; ++i) {
        ASSERT_FALSE(follower_.accept(offset(0.001 * i), time(i), time(i)));
        EXPECT_TRUE(step(i).allFinite());
    }
    EXPECT_GT(last_[0], model_.home()[0]);
}

TEST_F(StreamFollowerTest, AcceptsAJumpUpToItsLimitAndNoFurther) {
    // In the time of the play-out delay: twice the velocity limit.
    const double limit = 2.0 * model_.limits(0).velocity * 3 * kCycle;
    EXPECT_TRUE(follower_.accept(offset(limit + 1e-9), time(0), time(0)));
    EXPECT_TRUE(follower_.accept(offset(-limit - 1e-9), time(0), time(0)));
    EXPECT_FALSE(follower_.accept(offset(limit - 1e-9), time(0), time(0)));
    const auto next = [&](double angle) {
        return follower_.accept(offset(limit + angle), time(1), time(1));
    };
    EXPECT_EQ(next(limit / 3 + 1e-6)->reason, StreamRefusal::Reason::jump) << "in one cycle";
    EXPECT_FALSE(next(limit / 3 - 1e-6));
}

TEST_F(StreamFollowerTest, LeavesEverythingUnchangedByARefusedSetPoint) {
    StreamFollower other = follower_;
    for (int i = 0; i < 100; ++i) {
        const auto q = offset(0.002 * i);
        ASSERT_FALSE(follower_.accept(q, time(i), time(i)));
        ASSERT_FALSE(other.accept(q, time(i), time(i)));
        EXPECT_TRUE(other.accept(offset(3.0), time(i + 1), time(i)));
        EXPECT_TRUE(other.accept(offset(std::nan("")), time(i + 1), time(i)));
        EXPECT_TRUE(other.accept(JointVector(5), time(i + 1), time(i)));
        EXPECT_TRUE(other.accept(q, time(i), time(i)));
        ASSERT_EQ(other.next(time(i)).position, step(i)) << i;
    }
}

TEST_F(StreamFollowerTest, BrakesWhenItIsStoppedInTheMidstOfAStream) {
    int i = 0;
    for (; i < 150; ++i) {
        ASSERT_FALSE(follower_.accept(offset(0.2 * i * kCycle * i * kCycle), time(i), time(i)));
        step(i);
    }
    follower_.stop();
    EXPECT_EQ(follower_.state(), StreamFollower::State::stopping);
    EXPECT_EQ(follower_.accept(offset(0), time(i), time(i))->reason,
              StreamRefusal::Reason::timed_out);
    for (const int end = i + 200; follower_.state() == StreamFollower::State::stopping; ++i) {
        step(i);
        ASSERT_LT(i, end);
    }
    EXPECT_LE(worst_, 1.0);
    const auto held = last_;
    follower_.stop();
    EXPECT_LE(maxDifference(step(i), held), 1e-9);
    EXPECT_EQ(follower_.state(), StreamFollower::State::timed_out);
    EXPECT_EQ(follower_.missedCycles(), 0U);
}

TEST_F(StreamFollowerTest, RefusesEachOptionThatMakesNoSense) {
    const auto isRefused = [&](auto change) {
        StreamOptions options;
        change(options);
        const auto made = StreamFollower::create(model_, options, model_.home());
        return !made && made.error().code == Errc::invalid_argument;
    };
    EXPECT_FALSE(isRefused([](StreamOptions&) {}));
    for (const double wrong : {0.0, -1.0, std::nan("")}) {
        EXPECT_TRUE(isRefused([&](StreamOptions& o) { o.cycle = Seconds(wrong); })) << wrong;
        EXPECT_TRUE(isRefused([&](StreamOptions& o) { o.jump_factor = wrong; })) << wrong;
        EXPECT_TRUE(isRefused([&](StreamOptions& o) { o.jerk_factor = wrong; })) << wrong;
        EXPECT_TRUE(isRefused([&](StreamOptions& o) { o.braking_factor = wrong; })) << wrong;
    }
    EXPECT_TRUE(isRefused([](StreamOptions& o) { o.stale_cycles = 0; }));
    EXPECT_TRUE(isRefused([](StreamOptions& o) { o.extrapolated_cycles = -1; }));
    EXPECT_TRUE(isRefused([](StreamOptions& o) { o.standing_speed = -0.1; }));
    EXPECT_TRUE(isRefused([](StreamOptions& o) { o.standing_speed = std::nan(""); }));
    EXPECT_FALSE(StreamFollower::create(model_, {}, offset(std::nan(""))));
}

}  // namespace
}  // namespace metier::motion
