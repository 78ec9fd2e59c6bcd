// Arms behind position streams of other makers, which know nothing of metier.
#include <gmock/gmock.h>

#include <chrono>
#include <filesystem>
#include <memory>

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

TEST(ForeignArm, EndsTheMotionWhenItsStreamIsHaltedAndMovesAgainAfterReset) {
    ForeignArm foreign;
    const auto arm = connect(foreign);
    const auto move = std::make_shared<SmoothMove>(0.5, 100'000);
    ASSERT_TRUE(arm->attach(move));
    ASSERT_TRUE(foreign.awaitSetPoints(5));
    foreign.go(State::halted);
    ASSERT_EQ(move->awaitEnd(), EndCause::safety);
    EXPECT_THAT(move->text(), HasSubstr("the position stream ended (Halted)"));
    EXPECT_FALSE(arm->attach(std::make_shared<SmoothMove>(0.1, 30)));
    ASSERT_TRUE(resetUntilDone(*arm));
    EXPECT_TRUE(foreign.await(State::ready));
    const auto again = std::make_shared<SmoothMove>(0.1, 30);
    ASSERT_TRUE(arm->attach(again));
    EXPECT_EQ(again->awaitEnd(), EndCause::done) << again->text();
}

TEST(ForeignArm, IsHaltedAtAnEmergencyStop) {
    ForeignArm foreign;
    const auto arm = connect(foreign);
    const auto move = std::make_shared<SmoothMove>(0.5, 100'000);
    ASSERT_TRUE(arm->attach(move));
    ASSERT_TRUE(foreign.awaitSetPoints(5));
    foreign.pressEmergencyStop(true);
    ASSERT_EQ(move->awaitEnd(), EndCause::safety);
    EXPECT_EQ(arm->safety().state, SafetyState::emergency_stop);
    EXPECT_TRUE(foreign.await(State::halted)) << "a stream that nobody writes goes on";
    foreign.pressEmergencyStop(false);
    EXPECT_TRUE(awaitSafety(*arm, SafetyState::normal));
}

TEST(ForeignArm, IsHaltedWhenItsPositionIsLost) {
    ForeignArm foreign;
    const auto arm = connect(foreign);
    const auto move = std::make_shared<SmoothMove>(0.5, 100'000);
    ASSERT_TRUE(arm->attach(move));
    ASSERT_TRUE(foreign.awaitSetPoints(5));
    foreign.loseEncoders(true);
    ASSERT_EQ(move->awaitEnd(), EndCause::disconnected);
    EXPECT_TRUE(foreign.await(State::halted));
}

TEST(ForeignArm, IsHaltedWhenItRefusesASetPoint) {
    ForeignArm foreign;
    const auto arm = connect(foreign);
    const auto move = std::make_shared<SmoothMove>(0.5, 100'000);
    ASSERT_TRUE(arm->attach(move));
    ASSERT_TRUE(foreign.awaitSetPoints(5));
    foreign.refuseSetPoints();
    ASSERT_EQ(move->awaitEnd(), EndCause::safety);
    EXPECT_THAT(move->text(), HasSubstr("BadOutOfRange"));
    EXPECT_TRUE(foreign.await(State::halted));
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
