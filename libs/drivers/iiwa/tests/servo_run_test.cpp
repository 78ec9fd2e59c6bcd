// A stream of set-points, with the cabinet and the time moved by hand.
#include "servo_run.hpp"

#include <gmock/gmock.h>

#include "hand_moved.hpp"

namespace metier::iiwa_driver {
namespace {

using Kind = ServoFault::Kind;
using Next = device::SetPointSource::Next;
using Status = ServoRun::Status;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr double kCycle = 0.01;  // [s]

class ServoRunTest : public ::testing::Test {
protected:
    /// Begins, and sends all settings that are needed before the first set-point.
    void follow() {
        run_.begin(state_.position, settings_);
        while (run_.hurried()) {
            ASSERT_EQ(step(), Status::running);
        }
        sent_.clear();
    }
    Status step(int cycles = 1) {
        sent_.push_back(run_.command(source_, {}, cycles));
        if (sent_.back().code == Code::move_joints && follows_) {
            std::copy_n(sent_.back().arguments.begin(), kAxes, state_.position.begin());
        }
        return run_.take(sent_.back(), state_, kCycle, settings_);
    }
    Status steps(int count) {
        auto status = Status::running;
        for (int i = 0; i < count && status == Status::running; ++i) {
            status = step();
        }
        return status;
    }
    /// From now on each set-point is so far from the one before.
    void turns(std::size_t axis, double change) {
        source_.play = [=](device::JointArray& set_point) {
            set_point[axis] += change;
            return Next::set_point;
        };
    }
    std::vector<int> codes() const { return codesOf(sent_); }

    const motion::RobotModel model_ = iiwa7();
    CabinetState state_ = readyCabinet();
    CabinetSettings settings_;
    ServoRun run_{model_, kCycle};
    Player source_;
    bool follows_ = true;
    std::vector<Command> sent_;
};

TEST_F(ServoRunTest, TellsItsSettingsUnlessTheCabinetHasThem) {
    run_.begin(state_.position, settings_);
    steps(3);
    EXPECT_THAT(codes(), ElementsAre(201, 202, 302));
    EXPECT_EQ(source_.asked, 0);
    run_.begin(state_.position, settings_);
    EXPECT_FALSE(run_.hurried());
    step();
    EXPECT_THAT(codes(), ElementsAre(201, 202, 302, 102));
}

TEST_F(ServoRunTest, AsksForAsManySetPointsAsCyclesWentByAndSendsTheLast) {
    follow();
    turns(0, 1e-3);
    step(3);
    EXPECT_EQ(source_.asked, 3);
    EXPECT_NEAR(sent_.back().arguments[0], 3e-3, 1e-12);
    EXPECT_NEAR(run_.commanded()[0], 3e-3, 1e-12);
}

TEST_F(ServoRunTest, SendsTheLastSetPointOnceMoreWhenTheSourceIsDone) {
    follow();
    turns(0, 1e-3);
    step();
    source_.play = [](device::JointArray&) { return Next::done; };
    EXPECT_EQ(step(), Status::done);
    EXPECT_THAT(codes(), ElementsAre(102, 102));
    EXPECT_EQ(sent_[0].arguments, sent_[1].arguments);
}

TEST_F(ServoRunTest, IsCancelledOnceAndStopsAtStandstill) {
    follow();
    step();
    run_.stop();
    state_.velocity[2] = 0.1;
    EXPECT_EQ(steps(50), Status::running);
    EXPECT_THAT(codes(), ::testing::Contains(101).Times(1));
    EXPECT_EQ(source_.asked, 1);
    state_.velocity[2] = 0.0;
    EXPECT_EQ(step(), Status::stopped);
}

TEST_F(ServoRunTest, ThatIsStoppedBeforeItsFirstSetPointSendsNone) {
    run_.begin(state_.position, settings_);
    step();
    run_.stop();
    EXPECT_EQ(step(), Status::stopped);
    EXPECT_THAT(codes(), ElementsAre(201, 101));
    EXPECT_EQ(source_.asked, 0);
}

TEST_F(ServoRunTest, IsAFaultIfASettingIsRefusedAndTellsItAgainNextTime) {
    run_.begin(state_.position, settings_);
    step();
    state_.executed = false;
    EXPECT_EQ(step(), Status::running) << "first it brakes";
    EXPECT_EQ(step(), Status::fault);
    EXPECT_THAT(codes(), ElementsAre(201, 202, 101));
    EXPECT_EQ(toString(run_.fault()), "the cabinet refused: joint acceleration (202)");
    state_.executed = true;
    run_.begin(state_.position, settings_);
    sent_.clear();
    steps(2);
    EXPECT_THAT(codes(), ElementsAre(202, 302));
}

TEST_F(ServoRunTest, IsAFaultIfASetPointIsRefused) {
    follow();
    state_.executed = false;
    step();
    EXPECT_EQ(step(), Status::fault);
    EXPECT_THAT(codes(), ElementsAre(102, 101));
    EXPECT_THAT(toString(run_.fault()), HasSubstr("joint move (102)"));
}

TEST_F(ServoRunTest, StaysAFaultThatIsStopped) {
    follow();
    turns(0, 1.0);
    step();
    run_.stop();
    state_.velocity[0] = 0.1;
    EXPECT_EQ(steps(3), Status::running);
    state_.velocity[0] = 0.0;
    EXPECT_EQ(step(), Status::fault);
    EXPECT_THAT(codes(), ::testing::Contains(101).Times(1));
}

TEST_F(ServoRunTest, TakesSetPointsToTheEndsOfTheRangesWithTheirRounding) {
    for (const auto& [end, sign] :
         {std::pair(model_.limits(6).upper, 1.0), std::pair(model_.limits(6).lower, -1.0)}) {
        state_.position[6] = end;
        follow();
        turns(6, sign * 9e-7);
        step();
        EXPECT_EQ(codes().back(), 102);
        turns(6, sign * 2e-7);
        step();
        EXPECT_EQ(codes().back(), 101);
        EXPECT_EQ(run_.fault().kind, Kind::position);
        EXPECT_EQ(run_.fault().axis, 6U);
        EXPECT_EQ(run_.fault().limit, end);
    }
}

TEST_F(ServoRunTest, TakesStepsOfOneAndAHalfOfTheVelocityAndAMilliradian) {
    const double longest = 1.5 * model_.limits(3).velocity * kCycle + 1e-3;
    for (const double sign : {1.0, -1.0}) {
        follow();
        turns(3, sign * (longest - 1e-6));
        step();
        EXPECT_EQ(codes().back(), 102);
        turns(3, sign * (longest + 1e-6));
        step();
        EXPECT_EQ(codes().back(), 101);
        EXPECT_EQ(run_.fault().kind, Kind::step);
        EXPECT_EQ(run_.fault().axis, 3U);
        EXPECT_NEAR(run_.fault().limit, longest, 1e-12);
        steps(3);
    }
}

TEST_F(ServoRunTest, JudgesAlsoTheSetPointsThatAreLeftOut) {
    follow();
    int asked = 0;
    source_.play = [&](device::JointArray& set_point) {
        set_point[0] = ++asked == 2 ? 1.0 : 0.0;
        return Next::set_point;
    };
    step(3);
    EXPECT_THAT(codes(), ElementsAre(101));
    EXPECT_EQ(asked, 2);
}

TEST_F(ServoRunTest, ToleratesALagOfTwoTenthsForThreeTenthsOfASecond) {
    follow();
    follows_ = false;
    state_.position[4] -= 0.199;
    EXPECT_EQ(steps(100), Status::running);
    state_.position[4] -= 0.002;
    EXPECT_EQ(steps(29), Status::running);
    state_.position[4] += 0.1;
    step();
    state_.position[4] -= 0.1;
    EXPECT_EQ(steps(29), Status::running) << "counted anew";
    EXPECT_EQ(codes().back(), 102);
    EXPECT_EQ(steps(4), Status::fault);
    EXPECT_EQ(toString(run_.fault()), "axis 5 is 0.2010 rad from its set-point, limit 0.2000 rad");
}

}  // namespace
}  // namespace metier::iiwa_driver
