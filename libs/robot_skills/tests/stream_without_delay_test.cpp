#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "bench.hpp"
#include "stream/stream_input.hpp"

namespace metier::robot_skills {
namespace {

using skill::Reason;
using skill::State;
using skill::Value;
using ::testing::HasSubstr;

constexpr std::chrono::milliseconds kCycle{8};
// Largest error [rad] by the fading in of the first cycles of a sine, and by rounding.
constexpr double kExact = 1e-6;

/// A stream of axis 1 of a UR5 that is played after `delay` [s].
class DelayedStream {
public:
    explicit DelayedStream(double delay) : home_(bench_.commanded()[0]) {
        EXPECT_TRUE(bench_.start("PositionStreamSkill", {{"PlayOutDelay", delay}}));
    }

    void write(double angle, std::optional<UtcTime> meant_for = {}) {
        const auto joints = bench_.commanded();
        std::vector<double> target(joints.begin(), joints.end());
        target[0] = home_ + angle;
        const auto written =
            program().write(bench_.caller(), "TargetJointPosition", target, meant_for);
        ASSERT_TRUE(written) << written.error().message;
    }
    double angle() const { return bench_.commanded()[0] - home_; }
    Bench& bench() { return bench_; }
    skill::Program& program() { return bench_.program("PositionStreamSkill"); }

private:
    Bench bench_;
    double home_;
};

double sine(double cycle) {
    return 0.3 * (1 - std::cos(std::numbers::pi * 0.008 * cycle));
}

TEST(StreamWithoutDelay, SendsEachSetPointInTheNextCycle) {
    DelayedStream stream(0.0);
    for (int i = 0; i < 250; ++i) {
        stream.write(sine(i));
        stream.bench().step();
        ASSERT_EQ(stream.program().state(), State::running) << stream.program().reasonText();
        if (i > 20) {
            ASSERT_NEAR(stream.angle(), sine(i), kExact) << i;
        }
    }
    EXPECT_EQ(stream.bench().arm().state().safety, device::SafetyState::normal);
}

TEST(StreamWithDelay, SendsEachSetPointSoManyCyclesLater) {
    for (const int cycles : {1, 3, 10, 62}) {
        DelayedStream stream(0.008 * cycles);
        for (int i = 0; i < 250; ++i) {
            stream.write(sine(i));
            stream.bench().step();
            if (i > cycles + 20) {
                ASSERT_NEAR(stream.angle(), sine(i - cycles), kExact) << i << " of " << cycles;
            }
        }
    }
}

TEST(StreamWithDelay, RefusesADelayThatIsTooLong) {
    Bench bench;
    const auto refused = bench.start("PositionStreamSkill", {{"PlayOutDelay", 0.6}});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::out_of_range);
    EXPECT_THAT(refused.error().message, HasSubstr("PlayOutDelay: 0.6"));
}

TEST(StreamWithoutDelay, GoesOnWhereAWriterWithoutTimesIsLate) {
    DelayedStream stream(0.0);
    std::mt19937_64 random(3);
    int sent = 0;
    for (int i = 0; i < 1000; ++i) {
        if (i < 60 || random() % 3 != 0 || i - sent >= 3) {
            for (; sent <= i; ++sent) {
                stream.write(sine(sent));
            }
        }
        stream.bench().step();
        ASSERT_NEAR(stream.angle(), sine(i), 0.015) << i;  // two cycles at its top speed
    }
    stream.write(sine(1000));
    EXPECT_EQ(stream.program().state(), State::running) << stream.program().reasonText();
}

TEST(StreamWithoutDelay, HoldsTheLastSetPointOfAStreamThatStandsAndFinishes) {
    DelayedStream stream(0.0);
    for (int i = 0; i <= 126; ++i) {
        stream.write(sine(std::min(i, 125)));
        stream.bench().step();
    }
    ASSERT_TRUE(stream.bench().stepUntil("PositionStreamSkill", State::ready));
    EXPECT_NEAR(stream.angle(), sine(125), 1e-9);
    EXPECT_EQ(stream.program().finalResult().at("SetPoints"), Value(std::uint64_t{127}));
    EXPECT_EQ(stream.program().finalResult().at("MissedCycles"), Value(std::uint64_t{0}));
}

TEST(StreamWithoutDelay, BrakesAndIsHaltedWhenItFallsSilentMoving) {
    DelayedStream stream(0.0);
    for (int i = 0; i < 62; ++i) {
        stream.write(sine(i));
        stream.bench().step();
    }
    ASSERT_TRUE(stream.bench().stepUntil("PositionStreamSkill", State::halted));
    EXPECT_TRUE(stream.bench().arm().state().standstill);
    EXPECT_EQ(stream.program().reason(), Reason::error);
    EXPECT_THAT(stream.program().reasonText(), HasSubstr("fell silent while it moved"));
    // Three cycles more, then v/a + a/j of the UR5 at 0.94 rad/s with four times its jerk.
    EXPECT_LT(stream.angle(), sine(61) + 0.94 * (0.024 + (0.94 / 5 + 5.0 / 200) / 2) + 0.01);
}

TEST(StreamTimesInRhythm, EvenOutArrivals) {
    ManualClock clock;
    StreamTimes times(clock, kCycle, StreamTimes::Arrivals::rhythm);
    std::mt19937_64 random(5);
    auto last = times.next({}).count();
    std::chrono::microseconds before{0};
    for (int i = 1; i < 2000; ++i) {
        const std::chrono::microseconds jitter(static_cast<int>(random() % 2000));
        clock.advance(kCycle + jitter - before);
        before = jitter;
        const auto now = times.next({}).count();
        EXPECT_NEAR(now - last, 0.008, 0.0004) << i;
        EXPECT_NEAR(now, 0.008 * i + 0.001, 0.0015) << i;
        last = now;
    }
}

TEST(StreamTimesInRhythm, TakeUpAnotherRateAndAPause) {
    ManualClock clock;
    StreamTimes times(clock, std::chrono::milliseconds(2), StreamTimes::Arrivals::rhythm);
    times.next({});
    double arrival = 0.0;
    for (const int gap : {2, 2, 20, 20, 20, 20, 500, 2, 2, 2, 2}) {
        clock.advance(std::chrono::milliseconds(gap));
        arrival += 0.001 * gap;
        const double time = times.next({}).count();
        EXPECT_NEAR(time, arrival, 1e-9) << "after " << gap << " ms";
    }
}

}  // namespace
}  // namespace metier::robot_skills
