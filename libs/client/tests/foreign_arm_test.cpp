// Arms behind position streams of other makers, which know nothing of metier.
#include <gmock/gmock.h>

#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "foreign_arm.hpp"
#include "metier/client/remote_arm.hpp"
#include "metier/client/testing/arm_data.hpp"
#include "metier/motion/robot_model.hpp"
#include "moved_arm.hpp"

namespace metier::client {
namespace {

using namespace std::chrono_literals;
using device::EndCause;
using device::SafetyState;
using skill::State;
using testing::awaitSafety;
using ::testing::ElementsAre;
using testing::ForeignArm;
using ::testing::HasSubstr;
using testing::resetUntilDone;
using testing::SmoothMove;

const std::vector<std::string> kJoints{"base",    "shoulder", "elbow",
                                       "wrist_1", "wrist_2",  "wrist_3"};

GivenArm model() {
    const auto ur5 =
        motion::RobotModel::load(std::filesystem::path(METIER_MODELS) / "ur5.toml").value();
    GivenArm given;
    given.kinematics = testing::dataOf(ur5);
    given.joint_names = kJoints;
    return given;
}

RemoteArmOptions optionsFor(ForeignArm& foreign) {
    return {.url = foreign.url(), .retry_interval = 20ms, .given = model()};
}

std::unique_ptr<RemoteArm> connect(ForeignArm& foreign) {
    auto arm = RemoteArm::connect(optionsFor(foreign));
    EXPECT_TRUE(arm) << arm.error().message;
    return arm ? std::move(*arm) : nullptr;
}

Error refusal(const RemoteArmOptions& options) {
    const auto arm = RemoteArm::connect(options);
    EXPECT_FALSE(arm) << "it connects";
    return arm ? Error{} : arm.error();
}

/// Stays where the arm is, and notes when it is asked for set-points; stops the arm's thread once.
class StayingSource final : public device::SetPointSource {
public:
    explicit StayingSource(std::chrono::milliseconds pause = 0ms) : pause_(pause) {}

    Next next(const device::ArmState& /*state*/,
              device::JointArray& /*set_point*/) noexcept override {
        constexpr std::size_t kPauseAt = 20;
        auto now = std::chrono::steady_clock::now();
        const auto until = now + (times_.size() == kPauseAt ? pause_ : 0ms);
        while (now < until) {  // a thread that gets no processor
            now = std::chrono::steady_clock::now();
        }
        {
            const std::lock_guard lock(mutex_);
            times_.push_back(now);
        }
        asked_.notify_all();
        return Next::set_point;
    }
    void ended(EndCause /*cause*/, const device::Safety& /*safety*/) override {}

    /// Whether it was asked so often before that time.
    bool awaitCalls(std::size_t count, SteadyTime until) {
        std::unique_lock lock(mutex_);
        return asked_.wait_until(lock, until, [&] { return times_.size() >= count; });
    }
    std::vector<SteadyTime> times() {
        const std::lock_guard lock(mutex_);
        return times_;
    }

private:
    const std::chrono::milliseconds pause_;
    std::mutex mutex_;
    std::condition_variable asked_;
    std::vector<SteadyTime> times_;
};

/// An arm in the middle of a long move.
class MovingForeignArm : public ::testing::Test {
protected:
    void SetUp() override {
        ASSERT_TRUE(arm_);
        ASSERT_TRUE(arm_->attach(move_));
        ASSERT_TRUE(foreign_.awaitSetPoints(5));
    }

    ForeignArm foreign_;
    const std::unique_ptr<RemoteArm> arm_ = connect(foreign_);
    const std::shared_ptr<SmoothMove> move_ = std::make_shared<SmoothMove>(0.5, 100'000);
};

TEST(ForeignArm, MovesWithItsAxesInAnotherOrderAndInDegrees) {
    ForeignArm foreign;
    const auto arm = connect(foreign);
    ASSERT_TRUE(arm);
    EXPECT_EQ(arm->info().axis_names, kJoints);
    EXPECT_NEAR(arm->state().position[0], 0.1, 1e-12);
    const auto move = std::make_shared<SmoothMove>(0.2, 50);
    ASSERT_TRUE(arm->attach(move));
    ASSERT_EQ(move->awaitEnd(), EndCause::done) << move->text();
    EXPECT_NEAR(foreign.position("base"), 0.3, 1e-9);
    EXPECT_NEAR(foreign.position("shoulder"), 0.1, 1e-9);
    EXPECT_NEAR(foreign.position("wrist_3"), 0.1, 1e-9);
}

TEST(ForeignArm, IsReadyForOthersWhenTheEndOfAMotionIsTold) {
    ForeignArm foreign;
    const auto arm = connect(foreign);
    for (const double distance : {0.1, -0.1}) {
        const auto move = std::make_shared<SmoothMove>(distance, 30);
        ASSERT_TRUE(arm->attach(move));
        ASSERT_EQ(move->awaitEnd(), EndCause::done) << move->text();
    }
    EXPECT_THAT(foreign.calls(), ElementsAre("Start", "Halt", "Reset", "Start", "Halt", "Reset"));
    EXPECT_TRUE(foreign.await(State::ready));
    EXPECT_EQ(arm->safety().text, "");
}

TEST(ForeignArm, GetsThePlaceWhereItStandsBeforeItsStart) {
    ForeignArm foreign;
    const auto arm = connect(foreign);
    const auto move = std::make_shared<SmoothMove>(0.1, 30);
    ASSERT_TRUE(arm->attach(move));
    ASSERT_EQ(move->awaitEnd(), EndCause::done) << move->text();
    const auto first = foreign.targetAtStart();
    ASSERT_EQ(first.size(), 6U);
    for (const double joint : first) {
        EXPECT_NEAR(joint, 0.1, 1e-9) << "the set-point of the stream before was there";
    }
}

TEST(ForeignArm, GetsTheTimesOfItsSetPointsOnlyIfItTakesThem) {
    for (const bool takes_times : {true, false}) {
        ForeignArm foreign({.takes_times = takes_times});
        const auto arm = connect(foreign);
        const auto move = std::make_shared<SmoothMove>(0.1, 30);
        ASSERT_TRUE(arm->attach(move));
        ASSERT_EQ(move->awaitEnd(), EndCause::done) << move->text();
        EXPECT_EQ(foreign.times() > 0, takes_times);
        EXPECT_NEAR(foreign.position("base"), 0.2, 1e-9);
    }
}

TEST_F(MovingForeignArm, EndsTheMotionWhenItsStreamIsHaltedAndMovesAgainAfterReset) {
    foreign_.go(State::halted);
    ASSERT_EQ(move_->awaitEnd(), EndCause::safety);
    EXPECT_THAT(move_->text(), HasSubstr("the position stream ended (Halted)"));
    EXPECT_FALSE(arm_->attach(std::make_shared<SmoothMove>(0.1, 30)));
    ASSERT_TRUE(resetUntilDone(*arm_));
    EXPECT_TRUE(foreign_.await(State::ready));
    const auto again = std::make_shared<SmoothMove>(0.1, 30);
    ASSERT_TRUE(arm_->attach(again));
    EXPECT_EQ(again->awaitEnd(), EndCause::done) << again->text();
}

/// Whether the arm is seen to stand within that time.
bool standsWithin(const RemoteArm& arm, std::chrono::milliseconds limit) {
    for (const auto end = std::chrono::steady_clock::now() + limit;
         std::chrono::steady_clock::now() < end; std::this_thread::yield()) {
        if (arm.state().standstill) {
            return true;
        }
    }
    return false;
}

TEST(ForeignArm, DoesNotStandWhileItsServerDoesNotAnswer) {
    ForeignArm foreign;
    const auto arm = connect(foreign);
    ASSERT_TRUE(arm->attach(std::make_shared<SmoothMove>(0.5, 1000)));
    ASSERT_TRUE(foreign.awaitSetPoints(100));
    foreign.hold(true);
    EXPECT_FALSE(standsWithin(*arm, 700ms))
        << "its stream would be halted before it is at its last set-point";
    foreign.hold(false);
}

TEST(ForeignArm, DoesNotStandWhileItCreeps) {
    ForeignArm foreign;
    const auto arm = connect(foreign);
    ASSERT_TRUE(arm->attach(std::make_shared<SmoothMove>(0.03, 3000)));  // 4e-6 rad a cycle, later
    ASSERT_TRUE(foreign.awaitSetPoints(300));
    EXPECT_FALSE(standsWithin(*arm, 700ms));
}

TEST_F(MovingForeignArm, IsHaltedAtAnEmergencyStop) {
    foreign_.pressEmergencyStop(true);
    ASSERT_EQ(move_->awaitEnd(), EndCause::safety);
    EXPECT_EQ(arm_->safety().state, SafetyState::emergency_stop);
    EXPECT_TRUE(foreign_.await(State::halted)) << "a stream that nobody writes goes on";
    foreign_.pressEmergencyStop(false);
    EXPECT_TRUE(awaitSafety(*arm_, SafetyState::normal));
}

TEST_F(MovingForeignArm, IsHaltedAtAStopThatIsReleasedAtOnce) {
    foreign_.pressEmergencyStop(true);
    ASSERT_TRUE(foreign_.awaitStopReads(2));
    foreign_.pressEmergencyStop(false);
    ASSERT_TRUE(foreign_.await(State::halted));
    EXPECT_EQ(move_->awaitEnd(), EndCause::safety);
}

TEST_F(MovingForeignArm, IsHaltedWhenItsStopIsNotKnownAnyMore) {
    foreign_.loseStop(true);
    ASSERT_EQ(move_->awaitEnd(), EndCause::disconnected);
    EXPECT_TRUE(foreign_.await(State::halted));
    EXPECT_FALSE(arm_->attach(std::make_shared<SmoothMove>(0.1, 30)));
    foreign_.loseStop(false);
    EXPECT_TRUE(awaitSafety(*arm_, SafetyState::normal));
}

TEST(ForeignArm, LacksASafetyStateIfItsStopHasNoValue) {
    ForeignArm foreign;
    foreign.loseStop(true);
    const auto arm = connect(foreign);
    EXPECT_THAT(arm->lacks(), ElementsAre(Lack::atomic_start, Lack::dead_man, Lack::measured_state,
                                          Lack::safety_state));
    foreign.loseStop(false);
    foreign.pressEmergencyStop(true);
    EXPECT_TRUE(awaitSafety(*arm, SafetyState::emergency_stop));
}

TEST(ForeignArm, GetsNoSetPointsTogetherAfterAPause) {
    ForeignArm foreign;
    const auto arm = connect(foreign);
    const auto source = std::make_shared<StayingSource>(200ms);
    ASSERT_TRUE(arm->attach(source));
    ASSERT_TRUE(source->awaitCalls(32, testing::soon()));
    const auto times = source->times();
    EXPECT_GT(times[31] - times[21], 9 * arm->info().cycle) << "it went on from where it stood";
    arm->stop();
    EXPECT_TRUE(foreign.await(State::halted));
}

TEST(ForeignArm, GetsFewSetPointsThatWaitOnTheWay) {
    ForeignArm foreign;
    const auto arm = connect(foreign);
    const auto source = std::make_shared<StayingSource>();
    ASSERT_TRUE(arm->attach(source));
    ASSERT_TRUE(foreign.awaitSetPoints(5));
    foreign.hold(true);
    const auto before = source->times().size();
    EXPECT_FALSE(source->awaitCalls(before + 30, std::chrono::steady_clock::now() + 500ms))
        << "they would reach the arm together";
    foreign.hold(false);
    EXPECT_TRUE(source->awaitCalls(before + 40, testing::soon())) << "it goes on";
    arm->stop();
    EXPECT_TRUE(foreign.await(State::halted));
}

TEST(ForeignArm, DoesNotStandWhileOthersMoveIt) {
    ForeignArm foreign;
    const auto arm = connect(foreign);
    const auto move = std::make_shared<SmoothMove>(0.1, 30);
    ASSERT_TRUE(arm->attach(move));
    ASSERT_EQ(move->awaitEnd(), EndCause::done) << move->text();
    // A thread that gets no processor for 300 ms takes the arm for standing: one round has to do.
    int stood = 1;
    for (int round = 0; stood != 0 && round < 5; ++round) {
        stood = 0;
        for (int i = 0; i < 6; ++i) {
            foreign.push("base", 0.01);
            const auto there = foreign.position("base") - 1e-9;
            ASSERT_TRUE(testing::awaitState(*arm, [&](const device::ArmState& state) {
                stood += i > 0 && state.standstill ? 1 : 0;
                return state.position[0] >= there;
            }));
        }
    }
    EXPECT_EQ(stood, 0);
    EXPECT_TRUE(testing::awaitState(*arm, [](const auto& state) { return state.standstill; }));
}

TEST_F(MovingForeignArm, IsHaltedWhenItsPositionIsLost) {
    foreign_.loseEncoders(true);
    ASSERT_EQ(move_->awaitEnd(), EndCause::disconnected);
    EXPECT_TRUE(foreign_.await(State::halted));
}

TEST_F(MovingForeignArm, IsHaltedWhenItRefusesASetPoint) {
    foreign_.refuseSetPoints();
    ASSERT_EQ(move_->awaitEnd(), EndCause::safety);
    EXPECT_THAT(move_->text(), HasSubstr("BadOutOfRange"));
    EXPECT_TRUE(foreign_.await(State::halted));
}

TEST(ForeignArm, IsHaltedWhenItDoesNotFollow) {
    ForeignArm foreign({.follows = false});
    const auto arm = connect(foreign);
    const auto move = std::make_shared<SmoothMove>(1.0, 50);
    ASSERT_TRUE(arm->attach(move));
    ASSERT_EQ(move->awaitEnd(), EndCause::safety);
    EXPECT_THAT(move->text(), HasSubstr("base is "));
    EXPECT_TRUE(foreign.await(State::halted));
}

TEST(ForeignArm, IsHaltedByStopAndWhenItsComponentEnds) {
    ForeignArm foreign;
    auto arm = connect(foreign);
    const auto stopped = std::make_shared<SmoothMove>(0.5, 100'000);
    ASSERT_TRUE(arm->attach(stopped));
    ASSERT_TRUE(foreign.awaitSetPoints(5));
    arm->stop();
    EXPECT_EQ(stopped->awaitEnd(), EndCause::stopped);
    ASSERT_TRUE(foreign.await(State::halted));
    ASSERT_TRUE(arm->attach(std::make_shared<SmoothMove>(0.5, 100'000)));
    ASSERT_TRUE(foreign.await(State::running)) << "it resets what it has halted itself";
    arm.reset();
    EXPECT_TRUE(foreign.await(State::halted));
}

TEST(ForeignArm, TellsOfAStreamThatWasHaltedAtItsVeryEnd) {
    ForeignArm foreign;
    const auto arm = connect(foreign);
    foreign.haltsItselfNext();
    const auto move = std::make_shared<SmoothMove>(0.1, 30);
    ASSERT_TRUE(arm->attach(move));
    EXPECT_EQ(move->awaitEnd(), EndCause::safety);
    EXPECT_THAT(foreign.calls(), ElementsAre("Start", "Halt")) << "nobody has asked for a Reset";
    ASSERT_TRUE(resetUntilDone(*arm));
    EXPECT_TRUE(foreign.await(State::ready));
}

TEST_F(MovingForeignArm, IsNotResetAfterAStopThatCameTogetherWithItsOwn) {
    foreign_.haltsItselfNext();
    arm_->stop();
    EXPECT_EQ(move_->awaitEnd(), EndCause::stopped);
    EXPECT_TRUE(awaitSafety(*arm_, SafetyState::fault));
    EXPECT_FALSE(arm_->attach(std::make_shared<SmoothMove>(0.1, 30)));
}

TEST(ForeignArm, IsHaltedByResetIfItWasLeftRunning) {
    ForeignArm foreign({.state = State::running});  // of a component that was killed
    const auto arm = connect(foreign);
    const auto refused = std::make_shared<SmoothMove>(0.1, 30);
    ASSERT_TRUE(arm->attach(refused));
    EXPECT_EQ(refused->awaitEnd(), EndCause::safety);
    EXPECT_THAT(refused->text(), HasSubstr("Reset halts it"));
    ASSERT_TRUE(resetUntilDone(*arm));
    const auto move = std::make_shared<SmoothMove>(0.1, 30);
    ASSERT_TRUE(arm->attach(move));
    EXPECT_EQ(move->awaitEnd(), EndCause::done) << move->text();
}

TEST(ForeignArm, IsResetFirstIfItIsHalted) {
    ForeignArm foreign({.state = State::halted});
    const auto arm = connect(foreign);
    EXPECT_THAT(arm->safety().text, HasSubstr("its position stream is Halted"));
    EXPECT_FALSE(arm->attach(std::make_shared<SmoothMove>(0.1, 30)));
    ASSERT_TRUE(resetUntilDone(*arm));
    const auto move = std::make_shared<SmoothMove>(0.1, 30);
    ASSERT_TRUE(arm->attach(move));
    EXPECT_EQ(move->awaitEnd(), EndCause::done) << move->text();
}

TEST(ForeignArm, EndsTheMotionWhenItsServerIsGone) {
    auto foreign = std::make_unique<ForeignArm>();
    const auto arm = connect(*foreign);
    const auto move = std::make_shared<SmoothMove>(0.5, 100'000);
    ASSERT_TRUE(arm->attach(move));
    ASSERT_TRUE(foreign->awaitSetPoints(5));
    foreign.reset();
    EXPECT_EQ(move->awaitEnd(), EndCause::disconnected);
    EXPECT_TRUE(arm->absence());
}

TEST(ForeignArm, IsMovedByPosesIfItsStreamTakesNoJoints) {
    ForeignArm foreign({.takes_poses = true});
    EXPECT_THAT(refusal(optionsFor(foreign)).message, HasSubstr("has no TargetJointPosition"));
    auto options = optionsFor(foreign);
    options.given->pose_at = [](const device::JointArray& joints) { return Frame{joints[0]}; };
    const auto arm = RemoteArm::connect(options);
    ASSERT_TRUE(arm) << arm.error().message;
    const auto move = std::make_shared<SmoothMove>(0.2, 30);
    ASSERT_TRUE((*arm)->attach(move));
    ASSERT_TRUE(foreign.awaitSetPoints(31)) << "this arm stays where it is";
    const auto poses = foreign.poses();
    EXPECT_NEAR(poses.front(), 0.1, 1e-9);
    EXPECT_NEAR(poses[30], 0.3, 1e-9);
}

TEST(ForeignArm, TellsWhatItLacks) {
    ForeignArm whole;
    EXPECT_THAT(connect(whole)->lacks(),
                ElementsAre(Lack::atomic_start, Lack::dead_man, Lack::measured_state));
    EXPECT_EQ(textOf({Lack::measured_state}), "no measured state at the arm's rate");
    ForeignArm without({.has_safety = false});
    EXPECT_THAT(connect(without)->lacks(), ElementsAre(Lack::atomic_start, Lack::dead_man,
                                                       Lack::measured_state, Lack::safety_state));
}

TEST(ForeignArm, WithOtherArmsAtItsServerIsNotGuessed) {
    ForeignArm two_arms({.other_arm = true});
    EXPECT_THAT(refusal(optionsFor(two_arms)).message,
                HasSubstr("PositionStreamSkill could move any of Arm, OtherArm"));
    auto of_one = optionsFor(two_arms);
    of_one.given->device = "OtherArm";
    EXPECT_TRUE(RemoteArm::connect(of_one));
    ForeignArm two_streams({.other_stream = true});
    auto options = optionsFor(two_streams);
    const auto several = refusal(options);
    EXPECT_EQ(several.code, Errc::invalid_argument);
    EXPECT_THAT(several.message, HasSubstr("PositionStreamSkill of Controller, PositionStreamSkill "
                                           "of Other; choose one by controller"));
    options.controller = "Nobody";
    EXPECT_EQ(refusal(options).code, Errc::not_found);
    options.controller = "Other";
    const auto arm = RemoteArm::connect(options);
    EXPECT_TRUE(arm) << arm.error().message;
}

TEST(ForeignArm, IsRefusedWithTheReason) {
    ForeignArm foreign;
    EXPECT_THAT(refusal({.url = foreign.url()}).message, HasSubstr("no model is given"));
    ForeignArm other({.axes = {"Turn", "Lift", "Swing", "Roll", "Pitch", "Yaw"}});
    EXPECT_THAT(refusal(optionsFor(other)).message, HasSubstr("Turn, Lift, Swing"));
    auto ordered = optionsFor(other);
    ordered.given->array_order = kJoints;
    EXPECT_TRUE(RemoteArm::connect(ordered));
    ForeignArm endless({.has_reset = false});
    EXPECT_THAT(refusal(optionsFor(endless)).message, HasSubstr("has no Reset"));
}

}  // namespace
}  // namespace metier::client
