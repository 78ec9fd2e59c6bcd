#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "bench.hpp"
#include "stream/stream_input.hpp"

namespace metier::robot_skills {
namespace {

using skill::Reason;
using skill::State;
using skill::SubState;
using skill::Value;
using ::testing::HasSubstr;

constexpr std::chrono::milliseconds kCycle{8};
const std::string kTarget = "TargetJointPosition";
const std::string kEndOfStream = "EndOfStream";

/// The commanded joint position.
std::vector<double> jointsOf(const Bench& bench) {
    const auto joints = bench.commanded();
    return {joints.begin(), joints.end()};
}

class Stream : public ::testing::Test {
protected:
    Stream() : home(jointsOf(bench)) { EXPECT_TRUE(bench.start(kPositionStream, {})); }

    Result<void> write(const std::vector<double>& joints, std::optional<UtcTime> meant_for = {}) {
        return program.write(bench.caller(), kTarget, joints, meant_for);
    }
    /// Axis 1 at 0.3 sin(pi t), as a client that writes once per cycle.
    double sine(int cycle) const {
        return home[0] + 0.3 * (1 - std::cos(std::numbers::pi * 0.008 * cycle));
    }
    /// Streams so many cycles of the sine.
    void streamSine(int cycles) {
        for (int i = 0; i < cycles; ++i) {
            auto joints = home;
            joints[0] = sine(sent++);
            ASSERT_TRUE(write(joints));
            bench.step();
            ASSERT_EQ(program.state(), State::running) << program.reasonText();
        }
    }

    Bench bench;
    skill::Program& program = bench.program(kPositionStream);
    std::vector<double> home;
    int sent = 0;
};

TEST_F(Stream, FollowsItsClientAFewCyclesLater) {
    for (int i = 0; i < 250; ++i) {
        streamSine(1);
        if (i > 5) {
            const double lag = 0.3 * std::numbers::pi * 0.008 * 6;  // 6 cycles at the top speed
            ASSERT_NEAR(bench.commanded()[0], sine(i), lag);
        }
    }
    EXPECT_EQ(bench.arm().state().safety, device::SafetyState::normal);
}

TEST_F(Stream, IsNoLaterForSetPointsThatWaitedUntilTheArmWasReady) {
    for (; sent < 100; ++sent) {  // a slow part, in which the arm is not asked for set-points
        auto joints = home;
        joints[0] += 1e-5 * sent;
        ASSERT_TRUE(write(joints));
        bench.executor().advance(kCycle);
    }
    for (; sent < 400; ++sent) {
        auto joints = home;
        joints[0] += 1e-5 * sent;
        ASSERT_TRUE(write(joints));
        bench.step();
        ASSERT_EQ(program.state(), State::running) << program.reasonText();
    }
    EXPECT_NEAR(bench.commanded()[0] - home[0], 1e-5 * (sent - 1 - 3), 1e-5);
}

TEST_F(Stream, HoldsStillUntilTheFirstSetPoint) {
    const auto before = bench.commanded();
    bench.steps(100);
    EXPECT_EQ(bench.commanded(), before);
    EXPECT_EQ(program.state(), State::running);
}

TEST_F(Stream, IsFinishedWhenItFallsSilentStanding) {
    streamSine(125);
    auto joints = home;
    joints[0] = sine(125);  // the sine turns here: the stream stands
    ASSERT_TRUE(write(joints));
    bench.step();
    ASSERT_TRUE(write(joints));
    const auto silent_since = bench.executor().clock().now();
    ASSERT_TRUE(bench.stepUntil(kPositionStream, State::ready));
    const auto silence = bench.executor().clock().now() - silent_since;
    EXPECT_GE(silence, std::chrono::milliseconds(500));
    EXPECT_LE(silence, std::chrono::milliseconds(900));
    EXPECT_NEAR(bench.commanded()[0], joints[0], 1e-9);
    EXPECT_EQ(program.finalResult().at("SetPoints"), Value(std::uint64_t{127}));
    EXPECT_GT(std::get<double>(program.finalResult().at("Duration")), 1.5);
}

TEST_F(Stream, EndsAtItsLastSetPointWhenItIsToldThatNoneComes) {
    streamSine(125);
    auto joints = home;
    joints[0] = sine(125);  // the sine turns here: the stream stands
    ASSERT_TRUE(write(joints));
    bench.step();
    ASSERT_TRUE(write(joints));
    ASSERT_TRUE(program.write(bench.caller(), kEndOfStream, true));
    const auto refused = write(joints);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::invalid_state);
    const auto told = bench.executor().clock().now();
    ASSERT_TRUE(bench.stepUntil(kPositionStream, State::ready));
    EXPECT_NEAR(bench.commanded()[0], joints[0], 1e-5);
    EXPECT_TRUE(bench.arm().state().standstill);
    EXPECT_LE(bench.executor().clock().now() - told, 12 * kCycle) << "3 of them are PlayOutDelay";
    EXPECT_EQ(program.finalResult().at("SetPoints"), Value(std::uint64_t{127}));
    ASSERT_TRUE(bench.start(kPositionStream, {})) << "the next one has an end of its own";
    home = jointsOf(bench);
    sent = 0;
    streamSine(10);
}

TEST_F(Stream, IsSilentMovingWhenItsEndIsToldWhileItMoves) {
    streamSine(62);
    ASSERT_TRUE(program.write(bench.caller(), kEndOfStream, true));
    ASSERT_TRUE(bench.stepUntil(kPositionStream, State::halted));
    EXPECT_THAT(program.reasonText(), HasSubstr("fell silent while it moved at 0.94"));
}

TEST_F(Stream, EndsAtOnceWhenItIsToldSoBeforeTheFirstSetPoint) {
    ASSERT_TRUE(program.write(bench.caller(), kEndOfStream, true));
    const auto told = bench.executor().clock().now();
    ASSERT_TRUE(bench.stepUntil(kPositionStream, State::ready));
    EXPECT_LE(bench.executor().clock().now() - told, 5 * kCycle);
}

TEST_F(Stream, IsHaltedWhenItFallsSilentMoving) {
    streamSine(62);  // the fastest part
    ASSERT_TRUE(bench.stepUntil(kPositionStream, State::halted));
    EXPECT_TRUE(bench.arm().state().standstill);
    EXPECT_EQ(program.reason(), Reason::error);
    EXPECT_THAT(program.reasonText(), HasSubstr("fell silent while it moved at 0.94"));
    EXPECT_THAT(program.reasonText(), HasSubstr("rad/s: no set-point for 150 ms after 62"));
    ASSERT_TRUE(program.reset(bench.caller()));
    EXPECT_TRUE(bench.start(kPositionStream, {}));
}

TEST(PositionStream, IsHaltedWhenItFallsSilentMovingAlsoIfLongSilenceIsAllowed) {
    Bench bench("ur5", {}, {}, {.longest_silence = 1.0});
    auto& program = bench.program(kPositionStream);
    auto joints = jointsOf(bench);
    ASSERT_TRUE(bench.start(kPositionStream, {}));
    for (int i = 0; i < 50; ++i) {
        joints[0] += 0.005;
        ASSERT_TRUE(program.write(bench.caller(), kTarget, joints, {}));
        bench.step();
    }
    ASSERT_TRUE(bench.stepUntil([&] { return program.state() != State::running; }));
    EXPECT_EQ(program.state(), State::halted);
    EXPECT_EQ(program.reason(), Reason::error);
    EXPECT_THAT(program.reasonText(), HasSubstr("fell silent while it moved"));
}

TEST_F(Stream, IsFinishedWhenItNeverBegins) {
    ASSERT_TRUE(bench.stepUntil(kPositionStream, State::ready));
    EXPECT_GE(bench.arm().state().cycle, 1250U) << "10 s";
    EXPECT_EQ(program.finalResult().at("SetPoints"), Value(std::uint64_t{0}));
}

TEST_F(Stream, BrakesToStandstillForAHalt) {
    States states;
    Value intermediate;
    program.attach(states);
    states.told = [&](const auto& event) { intermediate = event.intermediate_result; };
    streamSine(62);
    ASSERT_TRUE(program.halt(bench.caller()));
    EXPECT_EQ(program.state(), State::running);
    ASSERT_TRUE(bench.stepUntil(kPositionStream, State::halted));
    EXPECT_TRUE(bench.arm().state().standstill);
    EXPECT_EQ(program.reason(), Reason::by_client);
    EXPECT_EQ(intermediate, Value(std::uint64_t{62}));
    program.detach(states);
}

TEST_F(Stream, BeginsAnewAfterASuspend) {
    streamSine(62);
    ASSERT_TRUE(program.suspend(bench.caller()));
    ASSERT_TRUE(bench.stepUntil(kPositionStream, State::suspended));
    EXPECT_TRUE(bench.arm().state().standstill);
    ASSERT_TRUE(program.resume(bench.caller()));
    home = jointsOf(bench);
    sent = 0;
    streamSine(125);
    EXPECT_NEAR(bench.commanded()[0], sine(124), 0.05);
}

TEST_F(Stream, RefusesToGoOnWhenTheArmWasMoved) {
    streamSine(10);
    ASSERT_TRUE(program.suspend(bench.caller()));
    ASSERT_TRUE(bench.stepUntil(kPositionStream, State::suspended));
    auto moved = bench.arm().state().commanded_position;
    moved[2] += 0.1;
    bench.arm().moveByHand(moved);
    bench.step();
    EXPECT_THAT(program.resume(bench.caller()).error().message, HasSubstr("axis 3 by 0.1000 rad"));
}

TEST_F(Stream, RefusesASetPointOutsideTheAxesRanges) {
    auto joints = home;
    joints[2] = 3.5;
    const auto written = write(joints);
    ASSERT_FALSE(written);
    EXPECT_EQ(written.error().code, Errc::out_of_range);
    EXPECT_EQ(written.error().message,
              "TargetJointPosition: axis 3: 3.5000 rad is outside -3.1416 to 3.1416 rad");
    streamSine(10);
}

TEST_F(Stream, IsHaltedByAJumpThatNoAxisCanFollow) {
    streamSine(20);
    auto joints = home;
    joints[1] += 1.0;
    ASSERT_TRUE(write(joints));
    ASSERT_TRUE(bench.stepUntil(kPositionStream, State::halted));
    EXPECT_EQ(program.reason(), Reason::limit_violated);
    EXPECT_EQ(program.subState(), SubState::halted_limit);
    EXPECT_THAT(program.reasonText(), HasSubstr("axis 2"));
    EXPECT_EQ(bench.arm().state().safety, device::SafetyState::normal)
        << "the controller never saw it";
}

TEST_F(Stream, TakesTheSendersTimesInsteadOfTheArrival) {
    const UtcTime start = bench.executor().clock().utcNow();
    for (int i = 0; i < 250; ++i) {  // in bursts of three, every third cycle
        if (i % 3 == 0) {
            for (int k = 0; k < 3; ++k) {
                auto joints = home;
                joints[0] = sine(i + k);
                ASSERT_TRUE(write(joints, start + std::chrono::milliseconds(8 * (i + k))));
            }
        }
        bench.step();
        ASSERT_EQ(program.state(), State::running) << program.reasonText();
        if (i > 10) {
            ASSERT_NEAR(bench.commanded()[0], sine(i), 0.3 * std::numbers::pi * 0.008 * 6);
        }
    }
}

TEST_F(Stream, DropsASetPointThatWasOvertaken) {
    const UtcTime start = bench.executor().clock().utcNow();
    for (const int cycle : {0, 1, 2, 4, 3, 5}) {
        auto joints = home;
        joints[0] = sine(cycle);
        ASSERT_TRUE(write(joints, start + kCycle * cycle));
        bench.step();
    }
    ASSERT_TRUE(program.halt(bench.caller()));
    ASSERT_TRUE(bench.stepUntil(kPositionStream, State::halted));
    EXPECT_EQ(program.lastTransition()->intermediate_result, Value(std::uint64_t{5}));
}

TEST_F(Stream, FollowsAClientWhoseSetPointsArriveInBursts) {
    for (int i = 0; i < 250; i += 3) {
        for (int k = 0; k < 3; ++k) {
            auto joints = home;
            joints[0] = sine(i + k);
            ASSERT_TRUE(write(joints));
        }
        bench.steps(3);
        ASSERT_EQ(program.state(), State::running) << program.reasonText();
    }
}

TEST_F(Stream, WaitsForAClientThatPauses) {
    streamSine(126);  // the sine turns at its end
    bench.steps(50);
    EXPECT_EQ(program.state(), State::running) << program.reasonText();
    streamSine(125);
    EXPECT_EQ(bench.arm().state().safety, device::SafetyState::normal);
}

TEST_F(Stream, IsStoppedByAProtectiveStop) {
    streamSine(62);
    bench.arm().protectiveStop("fence opened");
    ASSERT_TRUE(bench.stepUntil(kPositionStream, State::halted));
    EXPECT_EQ(program.reasonText(), "ur5: fence opened");
}

TEST(PositionStream, RefusesToBeginFarFromTheArm) {
    Bench bench;
    auto far = jointsOf(bench);
    far[4] += 1.0;
    const auto started = bench.start(kPositionStream, {{kTarget, far}});
    ASSERT_FALSE(started);
    EXPECT_THAT(started.error().message, HasSubstr("axis 5"));
    EXPECT_EQ(bench.program(kPositionStream).state(), State::ready);
}

TEST(PositionStream, BeginsWithTheSetPointGivenBefore) {
    Bench bench;
    auto near = jointsOf(bench);
    near[4] += 0.002;
    const auto started = bench.start(kPositionStream, {{kTarget, near}});
    ASSERT_TRUE(started) << started.error().message;
    ASSERT_TRUE(bench.stepUntil(kPositionStream, State::ready));
    EXPECT_NEAR(bench.commanded()[4], near[4], 1e-9);
    EXPECT_EQ(bench.program(kPositionStream).finalResult().at("SetPoints"),
              Value(std::uint64_t{1}));
}

TEST(StreamTimes, GiveTheArrivalWithoutATimeStamp) {
    ManualClock clock;
    StreamTimes times(clock, kCycle);
    EXPECT_EQ(times.next({}).count(), 0.0);
    clock.advance(std::chrono::milliseconds(8));
    EXPECT_DOUBLE_EQ(times.next({}).count(), 0.008);
}

TEST(StreamTimes, SpreadWhatArrivesTogether) {
    ManualClock clock;
    StreamTimes times(clock, kCycle);
    EXPECT_EQ(times.next({}).count(), 0.0);
    EXPECT_DOUBLE_EQ(times.next({}).count(), 0.004);
    EXPECT_DOUBLE_EQ(times.next({}).count(), 0.008);
    clock.advance(std::chrono::milliseconds(24));
    EXPECT_DOUBLE_EQ(times.next({}).count(), 0.024);
}

TEST(StreamTimes, GiveTheSendersTimeSinceTheFirst) {
    ManualClock clock;
    StreamTimes times(clock, kCycle);
    const UtcTime elsewhere{std::chrono::hours(1000)};
    EXPECT_EQ(times.next(elsewhere).count(), 0.0);
    clock.advance(std::chrono::milliseconds(30));
    EXPECT_DOUBLE_EQ(times.next(elsewhere + std::chrono::milliseconds(8)).count(), 0.008);
    times.restart();
    EXPECT_EQ(times.next({}).count(), 0.0);
}

// A value that was written before Start is the first set-point, the client's own begin right after.
TEST(StreamTimes, BeginTheSendersTimeACycleAfterASetPointWithoutOne) {
    ManualClock clock;
    StreamTimes times(clock, kCycle);
    EXPECT_EQ(times.next({}).count(), 0.0);
    clock.advance(std::chrono::microseconds(10));
    const UtcTime elsewhere{std::chrono::hours(1000)};
    EXPECT_DOUBLE_EQ(times.next(elsewhere).count(), 0.008);
    EXPECT_DOUBLE_EQ(times.next(elsewhere + std::chrono::milliseconds(8)).count(), 0.016);
}

TEST(StreamQueue, HoldsSoManyAndNoMore) {
    StreamQueue queue;
    EXPECT_EQ(queue.size(), 0U);
    for (std::size_t i = 0; i < StreamQueue::kCapacity; ++i) {
        ASSERT_TRUE(queue.tryPush({{static_cast<double>(i)}, {}}));
    }
    EXPECT_FALSE(queue.tryPush({}));
    EXPECT_EQ(queue.size(), StreamQueue::kCapacity);
    EXPECT_EQ(queue.tryPop()->position[0], 0.0);
    EXPECT_TRUE(queue.tryPush({}));
}

}  // namespace
}  // namespace metier::robot_skills
