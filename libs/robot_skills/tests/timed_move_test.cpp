#include <gmock/gmock.h>

#include "bench.hpp"
#include "moves/timetable.hpp"

namespace metier::robot_skills {
namespace {

using skill::Frame;
using skill::State;
using skill::ValueMap;
using ::testing::HasSubstr;

const ValueMap kTurn{{"TargetJointPosition", std::vector<double>(6, 0.5)},
                     {"Relative", std::int32_t{1}}};

ValueMap turnWith(const std::string& option, double value) {
    auto values = kTurn;
    values[option] = value;
    return values;
}

double now(Bench& bench) {
    return toSeconds(bench.executor().clock().utcNow());
}

double number(const skill::Program& program, const std::string& result) {
    return std::get<double>(program.finalResult().at(result));
}

TEST(Duration, IsWhatTheMotionTakes) {
    Bench bench;
    for (const auto& [skill, target] :
         {std::pair{kJointPtp, kTurn},
          std::pair{kCartesianLinear, ValueMap{{"TargetPosition", Frame{0, 0, 0.1}},
                                               {"Relative", std::int32_t{1}}}}}) {
        auto values = target;
        values["Duration"] = 4.0;
        ASSERT_TRUE(bench.start(skill, values));
        ASSERT_TRUE(bench.stepUntil(skill, State::ready));
        const auto& program = bench.program(skill);
        EXPECT_NEAR(number(program, "MotionEndTime") - number(program, "MotionStartTime"), 4.0,
                    0.008 + 1e-6);
        EXPECT_NEAR(number(program, "Duration"), 4.0, 0.008 + 1e-6);
    }
}

TEST(Duration, IsRefusedIfItIsShorterThanPossible) {
    Bench bench;
    const auto shortest = bench.program(kJointPtp).check(bench.caller(), kTurn).planned_duration;
    ASSERT_GT(shortest, 0.2);
    const auto started = bench.start(kJointPtp, turnWith("Duration", 0.1));
    ASSERT_FALSE(started);
    EXPECT_EQ(started.error().code, Errc::out_of_range);
    EXPECT_THAT(started.error().message, HasSubstr("Duration 0.1 s is shorter than possible: " +
                                                   std::to_string(shortest).substr(0, 5)));
    EXPECT_FALSE(bench.write(kJointPtp, {{"Duration", 0.0}}));
    EXPECT_TRUE(bench.start(kJointPtp, turnWith("Duration", shortest)));
}

TEST(Duration, ShowsInCheck) {
    Bench bench;
    const auto report = bench.program(kJointPtp).check(bench.caller(), turnWith("Duration", 7.5));
    EXPECT_TRUE(report.possible);
    EXPECT_NEAR(report.planned_duration, 7.5, 1e-6);
}

TEST(StartTime, IsKeptToTheCycle) {
    Bench bench;
    const double start = now(bench) + 0.3;
    const auto from = bench.commanded();
    ASSERT_TRUE(bench.start(kJointPtp, turnWith("StartTime", start)));
    while (now(bench) < start) {
        EXPECT_EQ(bench.commanded(), from) << start - now(bench) << " s before";
        EXPECT_EQ(bench.program(kJointPtp).state(), State::running);
        bench.step();
    }
    ASSERT_TRUE(bench.stepUntil(kJointPtp, State::ready));
    const auto& program = bench.program(kJointPtp);
    const double late = number(program, "MotionStartTime") - start;
    EXPECT_GE(late, 0.0);
    EXPECT_LE(late, 0.008 + 1e-6);
    EXPECT_LE(number(program, "LargestLateness"), 1e-6) << "the clock and the arm run alike";
}

TEST(StartTime, OfThePastOrFarAheadIsRefused) {
    Bench bench;
    auto started = bench.start(kJointPtp, turnWith("StartTime", now(bench) - 0.25));
    ASSERT_FALSE(started);
    EXPECT_THAT(started.error().message, HasSubstr("StartTime is 0.250 s ago"));
    started = bench.start(kJointPtp, turnWith("StartTime", now(bench) + 100.0));
    ASSERT_FALSE(started);
    EXPECT_THAT(started.error().message, HasSubstr("100.000 s ahead"));
    EXPECT_THAT(started.error().message, HasSubstr("limit 60 s"));
}

TEST(StartTime, ThatAnArmMissesEndsInAnError) {
    Bench bench;
    const auto from = bench.commanded();
    ASSERT_TRUE(bench.start(kJointPtp, turnWith("StartTime", now(bench) + 0.1)));
    bench.executor().advance(std::chrono::milliseconds(450));  // no cycle of the arm meanwhile
    ASSERT_TRUE(bench.stepUntil(kJointPtp, State::halted));
    EXPECT_EQ(bench.program(kJointPtp).reason(), skill::Reason::error);
    EXPECT_THAT(bench.program(kJointPtp).reasonText(), HasSubstr("s after StartTime, limit 0.1 s"));
    EXPECT_EQ(bench.commanded(), from);
}

TEST(StartTime, LetsTheMoveBeHaltedAndSuspendedWhileItWaits) {
    Bench bench;
    const auto from = bench.commanded();
    ASSERT_TRUE(bench.start(kJointPtp, turnWith("StartTime", now(bench) + 5.0)));
    bench.steps(10);
    ASSERT_TRUE(bench.program(kJointPtp).suspend(bench.caller()));
    ASSERT_TRUE(bench.stepUntil(kJointPtp, State::suspended));
    EXPECT_EQ(bench.commanded(), from);
    ASSERT_TRUE(bench.program(kJointPtp).resume(bench.caller()));
    bench.steps(20);
    EXPECT_FALSE(bench.commanded() == from) << "resumed: it begins at once";
    ASSERT_TRUE(bench.program(kJointPtp).halt(bench.caller()));
    ASSERT_TRUE(bench.stepUntil(kJointPtp, State::halted));
}

TEST(Timetable, TellsHowLateASetPointIs) {
    ManualClock clock;
    Timetable timetable(clock, toSeconds(clock.utcNow()) + 0.010);
    EXPECT_EQ(timetable.look(), Timetable::Due::not_yet);
    clock.advance(std::chrono::milliseconds(12));
    EXPECT_EQ(timetable.look(), Timetable::Due::now);
    EXPECT_NEAR(timetable.step(0.008), 0.002, 1e-6) << "[s] since the start";
    clock.advance(std::chrono::milliseconds(11));  // 3 ms late
    EXPECT_EQ(timetable.look(), Timetable::Due::now);
    EXPECT_NEAR(timetable.step(0.008), 0.008, 1e-9);
    EXPECT_NEAR(timetable.largestLateness(), 0.003, 1e-6);
    EXPECT_NEAR(timetable.lastTime() - timetable.firstTime(), 0.011, 1e-6);
}

TEST(StartTime, MayBeUpToAMinuteAhead) {
    const ManualClock clock;
    const double now = toSeconds(clock.utcNow());
    EXPECT_TRUE(checkStartTime({}, clock));
    EXPECT_TRUE(checkStartTime(now, clock));
    EXPECT_TRUE(checkStartTime(now + 59.9, clock));
    EXPECT_EQ(checkStartTime(now + 60.1, clock).error().code, Errc::out_of_range);
    EXPECT_EQ(checkStartTime(now - 0.1, clock).error().code, Errc::out_of_range);
}

TEST(Timetable, WithoutAStartTimeBeginsAtOnceWithAWholeCycle) {
    ManualClock clock;
    Timetable timetable(clock, {});
    EXPECT_EQ(timetable.firstTime(), 0.0) << "not begun";
    EXPECT_EQ(timetable.look(), Timetable::Due::now);
    EXPECT_NEAR(timetable.step(0.008), 0.008, 1e-9);
    EXPECT_NEAR(timetable.firstTime(), toSeconds(clock.utcNow()), 1e-6);
    clock.advance(std::chrono::milliseconds(5));  // 3 ms early
    EXPECT_EQ(timetable.look(), Timetable::Due::now);
    timetable.step(0.008);
    EXPECT_NEAR(timetable.largestLateness(), 0.003, 1e-6);
    clock.advance(std::chrono::milliseconds(9));
    EXPECT_EQ(timetable.look(), Timetable::Due::now);
    timetable.step(0.008);
    EXPECT_NEAR(timetable.largestLateness(), 0.003, 1e-6) << "the largest, not the last";
}

TEST(Timetable, MissesAStartThatIsMoreThanATenthOfASecondAgo) {
    for (const auto& [late, due] :
         {std::pair(99, Timetable::Due::now), std::pair(101, Timetable::Due::missed)}) {
        ManualClock clock;
        Timetable timetable(clock, toSeconds(clock.utcNow()) + 1.0);
        clock.advance(std::chrono::milliseconds(1000 + late));
        EXPECT_EQ(timetable.look(), due) << late;
        EXPECT_NEAR(timetable.missedBy(), 1e-3 * late, 1e-6);
    }
}

TEST(Timetable, BeginsAnewAfterASuspendWithoutItsStartTime) {
    ManualClock clock;
    Timetable timetable(clock, toSeconds(clock.utcNow()) + 1.0);
    EXPECT_EQ(timetable.look(), Timetable::Due::not_yet);
    timetable.restart();
    EXPECT_EQ(timetable.look(), Timetable::Due::now);
    EXPECT_NEAR(timetable.step(0.008), 0.008, 1e-9);
    clock.advance(std::chrono::seconds(3));
    timetable.restart();
    EXPECT_EQ(timetable.look(), Timetable::Due::now);
    EXPECT_NEAR(timetable.step(0.008), 0.008, 1e-9);
    EXPECT_LT(timetable.largestLateness(), 1e-6) << "the pause counts for nothing";
    EXPECT_NEAR(timetable.lastTime() - timetable.firstTime(), 3.0, 1e-6);
}

}  // namespace
}  // namespace metier::robot_skills
