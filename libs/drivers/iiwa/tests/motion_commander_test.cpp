// Everything that the cycle decides, with the cabinet and the time moved by hand.
#include "motion_commander.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "hand_moved.hpp"
#include "metier/motion/frame.hpp"

namespace metier::iiwa_driver {
namespace {

using device::EndCause;
using device::SafetyState;
using Next = device::SetPointSource::Next;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

using ::testing::Not;

class MotionCommanderTest : public ::testing::Test {
protected:
    explicit MotionCommanderTest(const IiwaOptions& options = {})
        : commander_({"iiwa", std::vector<std::string>(kAxes, "A"), 10ms}, model_, options) {}

    void connect() {
        place();
        commander_.connected(cabinet_, now_);
    }
    void ready() {
        connect();
        for (int i = 0; i < 4; ++i) {
            cycle();
        }
        ASSERT_EQ(commander_.core().safetyState(), SafetyState::normal);
        sent_.clear();
    }
    /// One command and its answer; the arm follows set-points at once.
    void cycle(std::chrono::milliseconds time = 10ms) {
        now_ += time;
        const auto command = commander_.command();
        sent_.push_back(command);
        cabinet_.executed =
            command.code != Code::state && static_cast<int>(command.code) != refused_;
        if (command.code == Code::move_joints && follows_) {
            std::copy_n(command.arguments.begin(), kAxes, cabinet_.position.begin());
        }
        place();
        commander_.take(command, cabinet_, now_);
        commander_.dispatch();
    }
    void cycles(int count) {
        for (int i = 0; i < count; ++i) {
            cycle();
        }
    }
    std::shared_ptr<Player> attach() {
        auto source = std::make_shared<Player>();
        source->play = [](device::JointArray& set_point) {
            set_point[0] += 1e-3;
            return Next::set_point;
        };
        const auto attached = commander_.attach(source);
        EXPECT_TRUE(attached) << attached.error().message;
        return source;
    }
    Result<void> move(double first_axis) {
        return commander_.move(ArmBench::toJoints(first_axis), outcome_.taker());
    }
    std::vector<int> codes() const { return codesOf(sent_); }
    std::string text() const { return commander_.core().safety().text; }
    SafetyState safety() const { return commander_.core().safetyState(); }
    device::ArmState state() const { return commander_.core().state(); }

    const motion::RobotModel model_ = iiwa7();
    MotionCommander commander_;
    CabinetState cabinet_ = readyCabinet();
    SteadyTime now_{1h};
    int refused_ = -1;
    bool follows_ = true;
    Outcome outcome_;
    std::vector<Command> sent_;

private:
    /// The cabinet's pose is where the model has the flange.
    void place() {
        motion::JointVector joints(kAxes);
        std::copy_n(cabinet_.position.begin(), kAxes, joints.begin());
        cabinet_.pose = motion::toFrame(model_.kinematics().forward(joints));
    }
};

// ---- first settings of every cabinet ----

TEST_F(MotionCommanderTest, TellsItsSettingsAtOnceAndIsReadyThen) {
    connect();
    EXPECT_TRUE(commander_.settlingIn());
    for (int i = 0; i < 3; ++i) {
        EXPECT_TRUE(commander_.hurried());
        EXPECT_EQ(safety(), SafetyState::disconnected);
        cycle();
    }
    EXPECT_THAT(codes(), ElementsAre(305, 302, 304));
    EXPECT_FALSE(commander_.settlingIn());
    EXPECT_FALSE(commander_.hurried());
    EXPECT_EQ(safety(), SafetyState::normal);
    EXPECT_EQ(text(), "");
    cycles(3);
    EXPECT_EQ(codes().back(), 0);
}

TEST_F(MotionCommanderTest, TellsASettingThatWasRefusedAgainAfterASecond) {
    connect();
    refused_ = 302;
    cycles(2);
    EXPECT_EQ(safety(), SafetyState::fault);
    EXPECT_EQ(text(), "iiwa: the cabinet refused: control interface (302)");
    EXPECT_FALSE(commander_.hurried());
    sent_.clear();
    cycles(99);
    EXPECT_THAT(codes(), Not(Contains(302)));
    refused_ = -1;
    cycles(2);
    EXPECT_THAT(codes(), Contains(302).Times(1));
    cycles(2);
    EXPECT_EQ(safety(), SafetyState::normal) << text();
}

TEST_F(MotionCommanderTest, IsTheFaultOfAnotherArmUntilItIsGone) {
    connect();
    cabinet_.position[1] += 0.01;
    now_ += 10ms;
    for (int i = 0; i < 3; ++i) {
        cabinet_.executed = true;
        commander_.take(commander_.command(), cabinet_, now_);
    }
    EXPECT_EQ(safety(), SafetyState::fault);
    EXPECT_THAT(text(), HasSubstr("iiwa: the cabinet sees the flange"));
    cycles(10);
    EXPECT_EQ(safety(), SafetyState::fault);
    EXPECT_FALSE(commander_.resetFault());
    commander_.lost("iiwa: gone");
    ready();
}

class MotionCommanderWithATool : public MotionCommanderTest {
protected:
    MotionCommanderWithATool() : MotionCommanderTest({.tool = 3}) {}
};

TEST_F(MotionCommanderWithATool, AttachesIt) {
    connect();
    cycles(4);
    EXPECT_THAT(codes(), ElementsAre(305, 302, 304, 400));
    EXPECT_EQ(sent_.back().arguments[0], 3);
    EXPECT_EQ(safety(), SafetyState::normal);
}

// ---- streams ----

TEST_F(MotionCommanderTest, LeavesOutFourSetPointsAtMost) {
    ready();
    const auto source = attach();
    cycles(5);
    const auto asked = source->asked;
    commander_.missedCycles(2);
    cycle();
    EXPECT_EQ(source->asked, asked + 3);
    commander_.missedCycles(100);
    cycle();
    EXPECT_EQ(source->asked, asked + 8);
    cycle();
    EXPECT_EQ(source->asked, asked + 9);
    EXPECT_EQ(state().missed_cycles, 102U);
}

TEST_F(MotionCommanderTest, DoesNotMakeUpForWhatWasMissedBeforeAStream) {
    ready();
    commander_.missedCycles(3);
    const auto source = attach();
    cycles(4);
    EXPECT_EQ(codes().back(), 102);
    EXPECT_EQ(source->asked, 1);
}

TEST_F(MotionCommanderTest, GoesBackToTheStandardInterfaceAfterAStream) {
    ready();
    const auto source = attach();
    cycles(5);
    source->play = [](device::JointArray&) { return Next::done; };
    cycle();
    EXPECT_EQ(source->cause, EndCause::done);
    sent_.clear();
    EXPECT_TRUE(commander_.hurried());
    cycles(2);
    EXPECT_THAT(codes(), ElementsAre(302, 0));
    EXPECT_EQ(sent_[0].arguments[0], 31);
}

TEST_F(MotionCommanderTest, TellsAChoreThatWasRefusedWithTheNextMotion) {
    ready();
    const auto source = attach();
    cycles(5);
    source->play = [](device::JointArray&) { return Next::done; };
    cycle();
    refused_ = 302;
    cycle();
    refused_ = -1;
    sent_.clear();
    ASSERT_TRUE(move(0.0));
    cycles(8);
    EXPECT_EQ(codes().front(), 302);
}

TEST_F(MotionCommanderTest, KeepsTheLastSetPointForTheCommandedPositionWhileTheArmIsNearIt) {
    ready();
    const auto source = attach();
    cycles(5);
    source->play = [](device::JointArray&) { return Next::done; };
    cycle();
    const auto commanded = state().commanded_position;
    EXPECT_NEAR(commanded[0], 2e-3, 1e-9);
    cabinet_.position[0] += 1.9e-3;
    cycles(2);
    EXPECT_EQ(state().commanded_position, commanded);
    cabinet_.position[0] += 2e-3;
    cabinet_.velocity[0] = 0.1;
    cycles(2);
    EXPECT_EQ(state().commanded_position, commanded) << "it may still be on its way";
    cabinet_.velocity[0] = 0.0;
    cycles(2);
    EXPECT_EQ(state().commanded_position, cabinet_.position) << "somebody moved it";
}

TEST_F(MotionCommanderTest, CommandsAnArmThatWasStoppedToStandWhereItIs) {
    ready();
    const auto source = attach();
    cycles(10);
    commander_.core().stop();
    cycle();
    cabinet_.position[0] += 0.01;
    cycles(2);
    EXPECT_EQ(source->cause, EndCause::stopped);
    EXPECT_EQ(state().commanded_position, cabinet_.position);
}

TEST_F(MotionCommanderTest, EndsAStreamForSafetyWhenTheCabinetIsNotReady) {
    ready();
    const auto source = attach();
    cycles(5);
    cabinet_.velocity[0] = 0.1;
    cycle();
    cabinet_.ready = false;
    cycles(3);
    EXPECT_EQ(safety(), SafetyState::protective_stop);
    EXPECT_THAT(text(), HasSubstr("iiwa: the cabinet is not ready to move"));
    EXPECT_FALSE(source->cause) << "it still moves";
    cycle();
    EXPECT_THAT(codes(), Contains(101).Times(1));
    cabinet_.velocity[0] = 0.0;
    cycles(2);
    EXPECT_EQ(source->cause, EndCause::safety);
    EXPECT_EQ(source->safety.state, SafetyState::protective_stop);
    EXPECT_FALSE(source->safety.limit_violated);
    EXPECT_THAT(commander_.resetFault().error().message, HasSubstr("not ready to move"));
    cabinet_.ready = true;
    cycle();
    EXPECT_EQ(safety(), SafetyState::normal);
}

TEST_F(MotionCommanderTest, TellsASafetyStopThatShowsInTheVeryLastAnswer) {
    ready();
    const auto source = attach();
    cycles(5);
    cabinet_.ready = false;
    cycles(18);
    commander_.core().stop();
    cycle();
    ASSERT_FALSE(source->cause && *source->cause == EndCause::safety);
    if (!source->cause) {
        cycle();
    }
    EXPECT_EQ(*source->cause == EndCause::safety,
              source->safety.state == SafetyState::protective_stop)
        << "the end and the safety state agree";
}

TEST_F(MotionCommanderTest, SaysThatItIsNotReadyRatherThanWhatFollowsFromIt) {
    ready();
    const auto source = attach();
    cycles(5);
    refused_ = 102;
    cycle();
    cabinet_.velocity[0] = 0.5;
    cycle();
    cabinet_.ready = false;
    cycles(20);
    cabinet_.velocity[0] = 0.0;
    cycles(30);
    EXPECT_EQ(source->cause, EndCause::safety);
    EXPECT_THAT(source->safety.text, HasSubstr("not ready to move"));
    refused_ = -1;
    cabinet_.ready = true;
    cycle();
    EXPECT_EQ(safety(), SafetyState::normal) << "nothing is to be reset";
}

TEST_F(MotionCommanderTest, KeepsAFaultUntilItIsResetAtStandstill) {
    ready();
    const auto source = attach();
    cycles(5);
    source->play = [](device::JointArray& set_point) {
        set_point[2] = std::nan("");
        return Next::set_point;
    };
    cycles(2);
    EXPECT_EQ(source->cause, EndCause::safety);
    EXPECT_EQ(safety(), SafetyState::protective_stop);
    EXPECT_EQ(text(), "iiwa: axis 3: set-point is not finite");
    EXPECT_TRUE(commander_.core().safety().limit_violated);
    cabinet_.velocity[0] = 0.2;
    cycles(5);
    EXPECT_EQ(safety(), SafetyState::protective_stop);
    EXPECT_EQ(commander_.resetFault().error().message, "iiwa: the arm still brakes");
    cabinet_.velocity[0] = 0.0;
    cycle();
    EXPECT_TRUE(commander_.resetFault());
    EXPECT_EQ(safety(), SafetyState::normal);
    cycles(5);
    EXPECT_EQ(safety(), SafetyState::normal);
    EXPECT_TRUE(commander_.resetFault()) << "there is nothing more to reset";
}

TEST_F(MotionCommanderTest, TakesNoRefusalForALimitThatWasViolated) {
    ready();
    const auto source = attach();
    refused_ = 302;
    cycles(6);
    EXPECT_EQ(source->cause, EndCause::safety);
    EXPECT_FALSE(source->safety.limit_violated);
    EXPECT_EQ(safety(), SafetyState::protective_stop);
}

// ---- motions of the cabinet ----

TEST_F(MotionCommanderTest, DoesOneThingAtATime) {
    ready();
    const auto source = attach();
    EXPECT_EQ(move(0.1).error().code, Errc::resource_unavailable);
    commander_.core().stop();
    cycles(5);
    ASSERT_TRUE(source->cause);
    ASSERT_TRUE(move(0.1));
    EXPECT_EQ(move(0.2).error().message, "iiwa: another motion runs");
    EXPECT_EQ(commander_.attach(std::make_shared<Player>()).error().message,
              "iiwa: a motion of the cabinet's planner runs");
}

TEST_F(MotionCommanderTest, IsCommandedToTheTargetAtTheEndOfAMotion) {
    ready();
    ASSERT_TRUE(move(0.1));
    cycles(4);
    cabinet_.position[0] = 0.0995;
    follows_ = false;
    cycles(40);
    ASSERT_TRUE(outcome_.told());
    EXPECT_TRUE(outcome_.get());
    EXPECT_EQ(state().commanded_position[0], 0.1);
}

TEST_F(MotionCommanderTest, IsCommandedToStandWhereAMotionToAPoseEnded) {
    ready();
    device::ControllerPlannedMotion motion;
    motion.target_flange = cabinet_.pose;
    ASSERT_TRUE(commander_.move(motion, outcome_.taker()));
    cycles(45);
    ASSERT_TRUE(outcome_.told());
    EXPECT_TRUE(outcome_.get());
    EXPECT_EQ(state().commanded_position, cabinet_.position);
}

TEST_F(MotionCommanderTest, CancelsAMotionThatIsStoppedOrForWhichItIsNotReady) {
    for (const bool ready_again : {true, false}) {
        ready();
        follows_ = false;
        ASSERT_TRUE(move(1.0));
        cabinet_.active = true;
        cabinet_.velocity[0] = 0.5;
        cycles(10);
        sent_.clear();
        if (ready_again) {
            commander_.stopMotion();
        } else {
            cabinet_.ready = false;
        }
        cycles(5);
        EXPECT_THAT(codes(), Contains(101));
        cabinet_.active = false;
        cabinet_.velocity[0] = 0.0;
        cycles(2);
        ASSERT_TRUE(outcome_.told());
        EXPECT_EQ(outcome_.get().has_value(), ready_again);
        cabinet_.ready = true;
        commander_.lost("iiwa: gone");
    }
}

TEST_F(MotionCommanderTest, ShowsTheSafetyStateTogetherWithTheEndOfAMotion) {
    ready();
    SafetyState at_the_end = SafetyState::normal;
    ASSERT_TRUE(commander_.move(ArmBench::toJoints(1.0), [&](const auto& outcome) {
        EXPECT_FALSE(outcome);
        at_the_end = commander_.core().safetyState();
    }));
    follows_ = false;
    cycles(4);
    cabinet_.ready = false;
    cycles(40);
    EXPECT_EQ(at_the_end, SafetyState::protective_stop);
}

// ---- the connection ----

TEST_F(MotionCommanderTest, EndsWhatMovesWhenTheCabinetIsGone) {
    ready();
    const auto source = attach();
    cycles(5);
    commander_.lost("iiwa: cabinet 10.0.0.7:3000: gone");
    EXPECT_EQ(safety(), SafetyState::disconnected);
    commander_.dispatch();
    EXPECT_EQ(source->cause, EndCause::disconnected);
    EXPECT_EQ(source->safety.text, "iiwa: cabinet 10.0.0.7:3000: gone");
    ready();
    ASSERT_TRUE(move(0.5));
    cycles(2);
    commander_.lost("iiwa: cabinet 10.0.0.7:3000: gone again");
    commander_.dispatch();
    ASSERT_TRUE(outcome_.told());
    EXPECT_EQ(outcome_.get().error().code, Errc::connection_lost);
    EXPECT_EQ(outcome_.get().error().message, "iiwa: cabinet 10.0.0.7:3000: gone again");
    EXPECT_EQ(move(0.5).error().code, Errc::connection_lost);
    EXPECT_EQ(commander_.resetFault().error().code, Errc::connection_lost);
}

TEST_F(MotionCommanderTest, TellsANewCabinetEverythingAnew) {
    ready();
    ASSERT_TRUE(move(0.0));
    cycles(40);
    ASSERT_TRUE(outcome_.told());
    commander_.missedCycles(3);
    commander_.lost("iiwa: gone");
    connect();
    EXPECT_EQ(state().missed_cycles, 3U) << "published with the first answer";
    sent_.clear();
    cycles(3);
    EXPECT_THAT(codes(), ElementsAre(305, 302, 304));
    EXPECT_EQ(state().missed_cycles, 0U);
    EXPECT_EQ(state().cycle, 4U);
    sent_.clear();
    ASSERT_TRUE(move(0.0));
    cycles(4);
    EXPECT_THAT(codes(), ElementsAre(201, 202, 211, 102));
}

TEST_F(MotionCommanderTest, ForgetsAFaultOfAnotherConnection) {
    ready();
    const auto source = attach();
    cycles(5);
    source->play = [](device::JointArray& set_point) {
        set_point[2] = std::nan("");
        return Next::set_point;
    };
    cycles(2);
    ASSERT_EQ(safety(), SafetyState::protective_stop);
    commander_.lost("iiwa: gone");
    ready();
    cycles(5);
    EXPECT_EQ(safety(), SafetyState::normal);
}

TEST_F(MotionCommanderTest, HasNothingToSendToACabinetThatOnlyStands) {
    ready();
    cycles(20);
    EXPECT_THAT(codes(), Not(Contains(Not(0))));
    EXPECT_THAT(commander_.toTell(), false);
}

}  // namespace
}  // namespace metier::iiwa_driver
