// A client whose clock steps, or that sends no times; the figures of the stream's report.
#include <gmock/gmock.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>

#include "bench.hpp"
#include "stream/stream_input.hpp"

namespace metier::robot_skills {
namespace {

using namespace std::chrono_literals;
using skill::Reason;
using skill::State;
using skill::Value;
using ::testing::HasSubstr;

constexpr std::chrono::milliseconds kCycle{8};

/// A client that streams a sine of axis 1, one set-point per cycle, by a clock of its own.
class ClientClock : public ::testing::Test {
protected:
    explicit ClientClock(const PositionStreamOptions& options = {})
        : bench_("ur5", {}, {}, options) {
        const auto joints = bench_.commanded();
        home_.assign(joints.begin(), joints.end());
        EXPECT_TRUE(bench_.start(kPositionStream, {}));
        began_ = bench_.executor().clock().utcNow();
    }

    double sine(int cycle) const {
        return home_[0] + 0.3 * (1 - std::cos(std::numbers::pi * 0.008 * cycle));
    }
    Result<void> write(const std::vector<double>& joints, std::optional<UtcTime> meant_for) {
        return program_.write(bench_.caller(), "TargetJointPosition", joints, meant_for);
    }
    Result<void> writeAxis1(double position, std::optional<UtcTime> meant_for) {
        auto joints = home_;
        joints[0] = position;
        return write(joints, meant_for);
    }
    UtcTime clientNow() const { return began_ + kCycle * cycle_ + step_; }
    /// So many cycles of the sine, or until the stream runs no more.
    void stream(int cycles) {
        for (int i = 0; i < cycles && program_.state() == State::running; ++i, ++cycle_) {
            static_cast<void>(writeAxis1(sine(cycle_), clientNow()));
            bench_.step();
        }
    }
    /// So many cycles where the sine is now.
    void stand(int cycles) {
        const double there = sine(cycle_ - 1);
        for (int i = 0; i < cycles && program_.state() == State::running; ++i, ++cycle_) {
            static_cast<void>(writeAxis1(there, clientNow()));
            bench_.step();
        }
    }
    /// Delay of the arm behind the sine [s], 0.25 s to 0.75 s after its begin.
    double behind() const {
        const double angle = (bench_.commanded()[0] - home_[0]) / 0.3;
        return 0.008 * (cycle_ - 1) - std::acos(1 - angle) / std::numbers::pi;
    }
    StreamReport::Figures figures() const { return bench_.streamFigures(); }

    Bench bench_;
    skill::Program& program_ = bench_.program(kPositionStream);
    std::vector<double> home_;
    UtcTime began_;
    std::chrono::nanoseconds step_{0};
    int cycle_ = 0;
};

TEST_F(ClientClock, LeavesNoTraceWhileItIsSteady) {
    stream(250);
    EXPECT_NEAR(figures().largest_lag, 0.0, 1e-9);
    EXPECT_NEAR(figures().clock_step, 0.0, 1e-9);
    EXPECT_EQ(figures().dropped, 0U);
    EXPECT_EQ(figures().refused, 0U);
}

TEST_F(ClientClock, ThatStepsAheadALittleIsInTheReport) {
    stream(32);
    step_ = 100ms;
    stream(55);
    EXPECT_EQ(program_.state(), State::running) << program_.reasonText();
    EXPECT_NEAR(behind(), 0.024 + 0.1, 0.008);
    EXPECT_NEAR(figures().lag, 0.1, 1e-6);
    EXPECT_NEAR(figures().largest_lag, 0.1, 1e-6);
    EXPECT_NEAR(figures().clock_step, 0.1, 1e-6);
}

class SteppedAhead : public ClientClock,
                     public ::testing::WithParamInterface<std::chrono::milliseconds> {};

TEST_P(SteppedAhead, EndsTheStreamWhichSaysWhy) {
    stream(62);
    step_ = GetParam();
    stream(250);
    ASSERT_TRUE(bench_.stepUntil(kPositionStream, State::halted));
    EXPECT_EQ(program_.lastTransition()->intermediate_result, Value(std::uint64_t{62}))
        << "at once";
    EXPECT_TRUE(bench_.arm().state().standstill);
    EXPECT_EQ(bench_.arm().state().safety, device::SafetyState::normal);
    EXPECT_EQ(program_.reason(), Reason::limit_violated);
    const double step = std::chrono::duration<double>(GetParam()).count();
    EXPECT_EQ(program_.reasonText(),
              fmt::format("the arm would be {:.3f} s behind its client, limit 0.250 s; the "
                          "client's clock went ahead by {:.3f} s",
                          step, step));
    EXPECT_NEAR(figures().largest_lag, step, 1e-6);
}

INSTANTIATE_TEST_SUITE_P(By, SteppedAhead,
                         ::testing::Values(300ms, 1000ms, std::chrono::milliseconds(3600s)),
                         [](const auto& of) {
                             return "Milliseconds" + std::to_string(of.param.count());
                         });

TEST_F(ClientClock, ThatStepsBackEndsAMovingStreamWhichSaysWhy) {
    stream(62);
    step_ = -1s;
    stream(250);
    ASSERT_TRUE(bench_.stepUntil(kPositionStream, State::halted));
    EXPECT_EQ(program_.reason(), Reason::error);
    EXPECT_THAT(program_.reasonText(), HasSubstr("the client's clock went back by 0.992 s; "));
    EXPECT_THAT(program_.reasonText(), HasSubstr("set-points were dropped for their times"));
    EXPECT_GT(figures().dropped, 10U);
}

TEST_F(ClientClock, ThatStepsBackEndsAStandingStreamWithAnError) {
    stream(126);
    stand(10);
    step_ = -1h;
    stand(250);
    EXPECT_EQ(program_.state(), State::halted) << "it is not finished: its client still sends";
    EXPECT_THAT(program_.reasonText(), HasSubstr("the client's clock went back by 3599.992 s"));
}

class PatientStream : public ClientClock {
protected:
    PatientStream() : ClientClock({.longest_silence = 0.4, .largest_lag = 0.25}) {}
};

TEST_F(PatientStream, WaitsAsLongAsItsOptionSays) {
    stream(62);
    bench_.steps(49);
    EXPECT_EQ(program_.state(), State::running) << program_.reasonText();
    ASSERT_TRUE(bench_.stepUntil(kPositionStream, State::halted));
    EXPECT_THAT(program_.reasonText(), HasSubstr("no set-point for 400 ms after 62"));
}

TEST_F(PatientStream, MayBeAsFarBehindItsClientAsASilenceMakesIt) {
    stream(32);
    step_ = 390ms;
    stream(30);
    EXPECT_EQ(program_.state(), State::running) << program_.reasonText();
    EXPECT_NEAR(figures().largest_lag, 0.39, 1e-6);
    step_ = 410ms;
    stream(30);
    ASSERT_TRUE(bench_.stepUntil(kPositionStream, State::halted));
    EXPECT_THAT(program_.reasonText(), HasSubstr("0.410 s behind its client, limit 0.400 s"));
}

TEST(ImpatientStream, IsSilentAfterSixCyclesAtLeast) {
    Bench bench("ur5", {}, {}, {.longest_silence = 0.0});
    const auto joints = bench.commanded();
    std::vector<double> target(joints.begin(), joints.end());
    ASSERT_TRUE(bench.start(kPositionStream, {}));
    for (int cycle = 0; cycle < 30; ++cycle) {
        target[0] += 4e-5 * cycle;  // up to 0.15 rad/s
        ASSERT_TRUE(bench.program(kPositionStream)
                        .write(bench.caller(), "TargetJointPosition", target, std::nullopt));
        bench.step();
    }
    bench.steps(5);
    EXPECT_EQ(bench.program(kPositionStream).state(), State::running);
    ASSERT_TRUE(bench.stepUntil(kPositionStream, State::halted));
    EXPECT_THAT(bench.program(kPositionStream).reasonText(), HasSubstr("no set-point for 48 ms"));
}

TEST_F(ClientClock, LagIsOverOnceTheArmRests) {
    stream(62);
    step_ = 100ms;
    stream(64);
    EXPECT_NEAR(figures().lag, 0.1, 1e-6);
    stand(40);
    EXPECT_LE(figures().lag, 1e-6);
    EXPECT_NEAR(figures().largest_lag, 0.1, 1e-6);
    cycle_ = 126;  // the sine goes on from its turn
    began_ += kCycle * 40;
    stream(32);
    EXPECT_EQ(program_.state(), State::running) << program_.reasonText();
    EXPECT_NEAR(bench_.commanded()[0], sine(cycle_ - 1 - 3), 6e-3);
    EXPECT_EQ(bench_.arm().state().safety, device::SafetyState::normal);
}

TEST_F(ClientClock, StepsAndWhatWasRefusedAreInTheResult) {
    stream(62);
    step_ = 100ms;
    stream(64);
    EXPECT_FALSE(writeAxis1(std::nan(""), clientNow()));
    const double there = sine(cycle_ - 1);
    stand(40);
    EXPECT_TRUE(writeAxis1(there, clientNow() - 3 * kCycle)) << "dropped for its time";
    bench_.step();
    EXPECT_TRUE(writeAxis1(there, clientNow()));
    ASSERT_TRUE(bench_.stepUntil(kPositionStream, State::ready)) << program_.reasonText();
    const auto result = program_.finalResult();
    EXPECT_NEAR(std::get<double>(result.at("LargestStreamLag")), 0.1, 1e-6);
    EXPECT_NEAR(std::get<double>(result.at("StreamClockStep")), 0.1, 1e-6);
    EXPECT_EQ(result.at("RefusedSetPoints"), Value(std::uint64_t{1}));
    EXPECT_EQ(result.at("DroppedSetPoints"), Value(std::uint64_t{1}));
}

TEST_F(ClientClock, ThatStepsWhileTheArmRestsDoesNotMakeItLeap) {
    stream(126);
    stand(40);
    step_ = 200ms;
    const double before = bench_.commanded()[0];
    ASSERT_TRUE(writeAxis1(before - 0.1, clientNow()));  // a leap, if it were a cycle's way
    double fastest = 0;
    for (int i = 0; i < 40 && program_.state() == State::running; ++i) {
        const double last = bench_.commanded()[0];
        bench_.step();
        fastest = std::max(fastest, std::abs(bench_.commanded()[0] - last) / 0.008);
    }
    EXPECT_LT(fastest, 1.5 * 0.1 / 0.2 + 0.1) << "it takes the time that the client told";
}

TEST_F(ClientClock, MayTellNothingOrAnythingAtAll) {
    for (const auto time : {UtcTime::min(), UtcTime::min() + 1ns, UtcTime{}, UtcTime::max()}) {
        SCOPED_TRACE(time.time_since_epoch().count());
        ManualClock clock;
        StreamTimes times(clock, kCycle);
        const double first = times.next(began_).count();
        clock.advance(kCycle);
        EXPECT_TRUE(std::isfinite(times.next(time).count()));
        clock.advance(kCycle);
        EXPECT_EQ(times.next(began_ + 2 * kCycle).count(), first + 0.016);
        times.restart();
        EXPECT_EQ(times.next(time).count(), 0.0);
        clock.advance(kCycle);
        EXPECT_TRUE(std::isfinite(times.next(began_).count()));
        EXPECT_TRUE(std::isfinite(times.next(UtcTime::max()).count()));
    }
}

TEST_F(ClientClock, OfTimeZeroIsNone) {
    for (; cycle_ < 62; ++cycle_) {
        ASSERT_TRUE(writeAxis1(sine(cycle_), UtcTime::min()));
        bench_.step();
    }
    EXPECT_EQ(program_.state(), State::running) << program_.reasonText();
    EXPECT_LT(behind(), 0.008 * 6);
}

TEST_F(ClientClock, LetsANanStandInTheReportAndInTheTextOfTheEnd) {
    stream(62);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (int i = 0; i < 30 && program_.state() == State::running; ++i, ++cycle_) {
        const auto refused = writeAxis1(nan, clientNow());
        if (program_.state() == State::running) {
            EXPECT_EQ(refused.error().code, Errc::out_of_range);
        }
        bench_.step();
    }
    ASSERT_TRUE(bench_.stepUntil(kPositionStream, State::halted));
    EXPECT_GE(figures().refused, 19U);
    EXPECT_THAT(program_.reasonText(), HasSubstr("fell silent while it moved"));
    EXPECT_THAT(program_.reasonText(),
                HasSubstr("were refused, the last one: TargetJointPosition[0]: nan rad is not "
                          "finite"));
}

TEST_F(ClientClock, FiguresAreThoseOfTheStreamThatRunsOrRanLast) {
    stream(62);
    step_ = 1s;
    stream(10);
    ASSERT_TRUE(bench_.stepUntil(kPositionStream, State::halted));
    EXPECT_GT(figures().largest_lag, 0.9);
    ASSERT_TRUE(program_.reset(bench_.caller()));
    ASSERT_TRUE(bench_.start(kPositionStream, {}));
    EXPECT_EQ(figures().largest_lag, 0.0);
    EXPECT_EQ(figures().clock_step, 0.0);
}

}  // namespace
}  // namespace metier::robot_skills
