#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "bench.hpp"

namespace metier::robot_skills {
namespace {

using device::SafetyState;
using skill::Frame;
using skill::Reason;
using skill::State;
using skill::SubState;
using skill::ValueMap;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

const ValueMap kUp{{"TargetPosition", Frame{0, 0, 0.1}}, {"Relative", std::int32_t{1}}};

// Cycles of 8 ms after which the line below is still far from its end.
constexpr int kUnderWay = 15;

/// A line of 10 cm upwards on a UR5, under way.
class MovingArm : public ::testing::Test {
protected:
    MovingArm() {
        from = bench.commandedPose().translation;
        to = from + Eigen::Vector3d(0, 0, 0.1);
        line.attach(states);
        EXPECT_TRUE(bench.start(kCartesianLinear, kUp));
        bench.steps(kUnderWay);
    }

    double offLine() { return distanceFromLine(bench.commandedPose().translation, from, to); }

    States states;
    Bench bench;
    skill::Program& line = bench.program(kCartesianLinear);
    Eigen::Vector3d from;
    Eigen::Vector3d to;
};

TEST_F(MovingArm, IsSuspendedAtStandstillOnItsPath) {
    ASSERT_TRUE(line.suspend(bench.caller()));
    EXPECT_EQ(line.subState(), SubState::stopping);
    EXPECT_FALSE(bench.arm().state().standstill);
    ASSERT_TRUE(bench.stepUntil(kCartesianLinear, State::suspended));
    EXPECT_TRUE(bench.arm().state().standstill);
    EXPECT_LE(offLine(), 1e-9);
    const auto rest = bench.commanded();
    bench.steps(50);
    EXPECT_EQ(bench.commanded(), rest);
}

TEST_F(MovingArm, SlowsDownInTheCycleAfterHalt) {
    Bench undisturbed;
    ASSERT_TRUE(undisturbed.start(kCartesianLinear, kUp));
    undisturbed.steps(kUnderWay);
    ASSERT_EQ(undisturbed.commanded(), bench.commanded());
    ASSERT_TRUE(line.halt(bench.caller()));
    bench.step();
    undisturbed.step();
    EXPECT_LT(bench.commandedPose().translation.z(), undisturbed.commandedPose().translation.z());
}

TEST_F(MovingArm, IsHaltedAtStandstillOnItsPath) {
    ASSERT_TRUE(line.halt(bench.caller()));
    while (line.state() != State::halted) {
        ASSERT_EQ(line.state(), State::running);
        ASSERT_LE(offLine(), 1e-9);
        bench.step();
    }
    EXPECT_TRUE(bench.arm().state().standstill);
    EXPECT_EQ(line.subState(), SubState::halted_by_client);
    EXPECT_THAT(states.seen, ElementsAre(State::running, State::halted));
    ASSERT_TRUE(line.reset(bench.caller()));
    EXPECT_EQ(line.state(), State::ready);
    EXPECT_TRUE(bench.start(kCartesianLinear, kUp));
}

/// Cycles from a request in the cycle `when` of a line of 40 cm, which speeds up by 0.3 m/s2, to
/// its standstill.
int cyclesToRest(Result<void> (skill::Program::*request)(const skill::Caller&), int when) {
    const ValueMap fast{{"TargetPosition", Frame{0, 0, 0.4}},
                        {"Relative", std::int32_t{1}},
                        {"MaxAcceleration", std::vector<double>{0.3, 0.3, 0.3, 1, 1, 1}}};
    Bench bench;
    EXPECT_TRUE(bench.start(kCartesianLinear, fast));
    bench.steps(when);
    EXPECT_TRUE((bench.program(kCartesianLinear).*request)(bench.caller()));
    int cycles = 0;
    EXPECT_TRUE(bench.stepUntil([&] {
        ++cycles;
        return bench.arm().state().standstill;
    }));
    return cycles;
}

// To lose its speed within the limits of the move takes as long as it took to gain it.
TEST(HaltedArm, BrakesHarderThanItsMoveSpeedsUpAndNoLaterThanForSuspend) {
    for (const int when : {50, 75}) {
        const int halted = cyclesToRest(&skill::Program::halt, when);
        EXPECT_LE(halted, cyclesToRest(&skill::Program::suspend, when)) << "cycle " << when;
        EXPECT_LT(halted, when);
    }
}

TEST_F(MovingArm, CanBeHaltedWhileItComesToRestForASuspend) {
    ASSERT_TRUE(line.suspend(bench.caller()));
    bench.step();
    ASSERT_TRUE(line.halt(bench.caller()));
    ASSERT_TRUE(bench.stepUntil(kCartesianLinear, State::halted));
    EXPECT_LE(offLine(), 1e-9);
}

TEST_F(MovingArm, CanBeGivenUpWhileSuspended) {
    ASSERT_TRUE(line.suspend(bench.caller()));
    ASSERT_TRUE(bench.stepUntil(kCartesianLinear, State::suspended));
    ASSERT_TRUE(line.halt(bench.caller()));
    bench.step();
    EXPECT_EQ(line.state(), State::halted);
    EXPECT_TRUE(bench.start(kCartesianPtp, kUp)) << "the arm is free again";
}

TEST_F(MovingArm, IsStoppedByAProtectiveStopWithItsReason) {
    bench.arm().protectiveStop("fence opened");
    ASSERT_TRUE(bench.stepUntil(kCartesianLinear, State::halted));
    EXPECT_TRUE(bench.arm().state().standstill);
    EXPECT_EQ(line.reason(), Reason::error);
    EXPECT_EQ(line.reasonText(), "ur5: fence opened");
    ASSERT_TRUE(line.reset(bench.caller()));
    bench.step();
    EXPECT_EQ(bench.arm().state().safety, SafetyState::normal);
    ASSERT_TRUE(bench.start(kCartesianLinear, kUp));
    EXPECT_TRUE(bench.stepUntil(kCartesianLinear, State::ready));
}

TEST_F(MovingArm, StaysHaltedWhileTheEmergencyStopIsPressed) {
    bench.arm().emergencyStop(joint_simulator::EmergencyStop::pressed);
    ASSERT_TRUE(bench.stepUntil(kCartesianLinear, State::halted));
    EXPECT_THAT(line.reset(bench.caller()).error().message, HasSubstr("still pressed"));
    EXPECT_EQ(line.state(), State::halted);
    bench.arm().emergencyStop(joint_simulator::EmergencyStop::released);
    bench.step();
    EXPECT_TRUE(line.reset(bench.caller()));
}

TEST_F(MovingArm, IsLostWhenItsControllerIsGone) {
    bench.arm().disconnect();
    bench.step();
    EXPECT_EQ(line.state(), State::halted);
    EXPECT_EQ(line.subState(), SubState::halted_device_lost);
    EXPECT_THAT(line.reasonText(), HasSubstr("no connection"));
    EXPECT_EQ(line.reset(bench.caller()).error().code, Errc::connection_lost);
}

TEST_F(MovingArm, UsesTheArmsOwnStopWhenItDoesNotComeToRestInTime) {
    skill::ProgramOptions impatient;
    impatient.rest_deadline = std::chrono::milliseconds(1);
    ASSERT_TRUE(bench.stepUntil(kCartesianLinear, State::ready));
    auto skills = makeArmSkills({bench.arm()}, bench.model(), bench.executor().clock()).value();
    auto executor = std::make_shared<skill::testing::ManualExecutor>();
    skill::Program program(impatient, std::move(skills.moves[1]), executor, executor->clock());
    ASSERT_TRUE(program.write(bench.caller(), "TargetPosition", Frame{0, 0, -0.1}));
    ASSERT_TRUE(program.write(bench.caller(), "Relative", std::int32_t{1}));
    ASSERT_TRUE(program.start(bench.caller()));
    bench.steps(kUnderWay);
    ASSERT_TRUE(program.halt(bench.caller()));
    executor->advance(std::chrono::milliseconds(2));
    EXPECT_EQ(program.state(), State::halted);
    const auto early = program.reset(bench.caller());
    ASSERT_FALSE(early) << "a Start would be refused";
    EXPECT_THAT(early.error().message, HasSubstr("the arm still moves"));
    EXPECT_TRUE(bench.stepUntil([&] { return bench.arm().state().standstill; }));
    EXPECT_TRUE(program.reset(bench.caller()));
    EXPECT_EQ(program.state(), State::ready);
}

TEST_F(MovingArm, ComesToRestWhenItsProgramIsGone) {
    bench.destroyProgram(kCartesianLinear);
    bench.steps(100);
    EXPECT_TRUE(bench.arm().state().standstill);
    EXPECT_EQ(bench.arm().state().safety, SafetyState::normal);
    EXPECT_TRUE(bench.start(kCartesianPtp, kUp));
}

/// A line of 10 cm upwards on a UR5, suspended on its way.
class SuspendedArm : public MovingArm {
protected:
    SuspendedArm() {
        EXPECT_TRUE(line.suspend(bench.caller()));
        EXPECT_TRUE(bench.stepUntil(kCartesianLinear, State::suspended));
        rest = bench.arm().state().commanded_position;
    }

    device::JointArray rest;
};

TEST_F(SuspendedArm, GoesOnAlongTheSamePathToTheEnd) {
    ASSERT_TRUE(line.resume(bench.caller()));
    while (line.state() == State::running) {
        bench.step();
        ASSERT_LE(offLine(), 1e-9);
    }
    EXPECT_EQ(line.state(), State::ready) << line.reasonText();
    EXPECT_LE((bench.commandedPose().translation - to).norm(), 1e-9);
    EXPECT_THAT(states.seen,
                ElementsAre(State::running, State::suspended, State::running, State::ready));
}

TEST_F(SuspendedArm, DoesNotGoOnWhenItWasMovedTooFar) {
    auto moved = rest;
    moved[1] += 0.01;
    bench.arm().moveByHand(moved);
    bench.step();
    const auto resumed = line.resume(bench.caller());
    ASSERT_FALSE(resumed);
    EXPECT_EQ(resumed.error().code, Errc::out_of_range);
    EXPECT_THAT(resumed.error().message,
                HasSubstr("axis 2 by 0.0100 rad, limit 0.002 rad; the tool frame by 0.00"));
    EXPECT_EQ(line.state(), State::suspended);
    bench.arm().moveByHand(rest);
    bench.step();
    ASSERT_TRUE(line.resume(bench.caller()));
    EXPECT_TRUE(bench.stepUntil(kCartesianLinear, State::ready));
}

TEST_F(SuspendedArm, GoesBackToItsPathWhenItWasMovedALittle) {
    auto moved = rest;
    moved[1] += 0.0015;
    bench.arm().moveByHand(moved);
    bench.step();
    ASSERT_TRUE(line.resume(bench.caller()));
    bench.steps(26);  // the way back takes 0.2 s
    while (line.state() == State::running) {
        ASSERT_LE(offLine(), 1e-9);
        bench.step();
    }
    EXPECT_EQ(line.state(), State::ready) << line.reasonText();
    EXPECT_LE((bench.commandedPose().translation - to).norm(), 1e-9);
}

TEST_F(SuspendedArm, IsHaltedByAProtectiveStop) {
    bench.arm().protectiveStop("fence opened");
    bench.step();
    bench.step();
    EXPECT_EQ(line.state(), State::halted);
    EXPECT_EQ(line.reasonText(), "ur5: fence opened");
}

TEST_F(SuspendedArm, IsLostWhenItsControllerIsGone) {
    bench.arm().disconnect();
    bench.step();
    EXPECT_EQ(line.state(), State::halted);
    EXPECT_EQ(line.subState(), SubState::halted_device_lost);
}

TEST_F(SuspendedArm, CanBeSuspendedAgainAndAgain) {
    for (int i = 0; i < 5; ++i) {
        ASSERT_TRUE(line.resume(bench.caller()));
        bench.steps(3);
        const auto suspended = line.suspend(bench.caller());
        ASSERT_TRUE(suspended) << i << suspended.error().message;
        ASSERT_TRUE(bench.stepUntil(kCartesianLinear, State::suspended));
        ASSERT_LE(offLine(), 1e-9);
    }
}

/// One line, suspended after `cycles` and resumed: the largest distance from it [m].
double worstOfSuspendedLine(Bench& bench, int cycles, double height) {
    const auto from = bench.commandedPose().translation;
    const Eigen::Vector3d to = from + Eigen::Vector3d(0, 0, height);
    auto& line = bench.program(kCartesianLinear);
    auto values = kUp;
    values["TargetPosition"] = Frame{0, 0, height};
    const auto started = bench.start(kCartesianLinear, values);
    EXPECT_TRUE(started) << started.error().message;
    double worst = 0;
    int step = 0;
    const auto done = bench.stepUntil([&] {
        worst = std::max(worst, distanceFromLine(bench.commandedPose().translation, from, to));
        if (step++ == cycles) {
            static_cast<void>(line.suspend(bench.caller()));  // refused if it has just finished
        }
        if (line.state() == State::suspended) {
            EXPECT_TRUE(line.resume(bench.caller()));
        }
        return line.state() == State::ready;
    });
    EXPECT_TRUE(done) << line.reasonText();
    EXPECT_LE((bench.commandedPose().translation - to).norm(), 1e-9);
    return worst;
}

TEST(SuspendedLine, NeverLeavesItsPathWhereverItIsSuspended) {
    std::mt19937 random(20260);  // NOLINT(cert-msc51-cpp,cert-msc32-c): repeatable on purpose
    std::uniform_int_distribution<int> cycles(0, 70);
    Bench bench;
    for (int i = 0; i < 200; ++i) {
        const double height = i % 2 == 0 ? 0.1 : -0.1;
        ASSERT_LE(worstOfSuspendedLine(bench, cycles(random), height), 1e-9);
    }
}

TEST(MoveSkills, EndInHaltedLimitWhenASetPointBreaksTheControllersLimit) {
    Bench bench("ur5", [](auto& options) { options.limits[1].velocity = 0.05; });
    ASSERT_TRUE(bench.start(kCartesianLinear, kUp));
    ASSERT_TRUE(bench.stepUntil(kCartesianLinear, State::halted));
    const auto& program = bench.program(kCartesianLinear);
    EXPECT_EQ(program.reason(), Reason::limit_violated);
    EXPECT_EQ(program.subState(), SubState::halted_limit);
    EXPECT_THAT(program.reasonText(), HasSubstr("ur5: axis 2: velocity 0.0"));
    EXPECT_THAT(program.reasonText(), HasSubstr("rad/s over limit 0.0500 rad/s"));
}

TEST(MoveSkills, FailWhenTheArmDoesNotGetThere) {
    Bench bench("ur5", [](auto& options) { options.time_constant = 2.0; });
    ASSERT_TRUE(bench.start(kCartesianLinear, kUp));
    ASSERT_TRUE(bench.stepUntil(kCartesianLinear, State::halted));
    EXPECT_THAT(bench.program(kCartesianLinear).reasonText(),
                AllOf(HasSubstr("rad off its set-point "),
                      HasSubstr(" s after the motion, limit 0.001 rad")));
}

}  // namespace
}  // namespace metier::robot_skills
