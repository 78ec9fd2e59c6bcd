// Whole sessions with a controller that does what it should.

#include "arm_fixture.hpp"

namespace metier::ur_driver {
namespace {

TEST_F(ArmTest, FollowsASourceToItsEnd) {
    openReady();
    const double start = arm().state().commanded_position[0];
    auto source = attach(0.2, 60);
    EXPECT_EQ(source->outcome(), EndCause::done) << source->safety().text;
    EXPECT_EQ(source->asked(), 61);
    EXPECT_EQ(source->ends(), 1);
    EXPECT_NEAR(arm().state().commanded_position[0], start + 0.2, 1e-9);
    EXPECT_TRUE(fake_.await([&] { return arm().state().position[0] > start + 0.2 - 1e-9; }));
    EXPECT_NEAR(fake_.target()[0], start + 0.2, 1e-9);
}

TEST_F(ArmTest, TellsNamesAndCycle) {
    openReady();
    EXPECT_EQ(arm().info().name, "ur5");
    EXPECT_EQ(arm().info().axisCount(), 6U);
    EXPECT_EQ(arm().info().axis_names[2], "elbow");
    EXPECT_EQ(arm().info().cycle, std::chrono::milliseconds(8));
}

TEST_F(ArmTest, DoesNotUploadAnythingBeforeItIsAttached) {
    openReady();
    EXPECT_TRUE(fake_.await([&] { return arm().state().cycle > 20; }));
    EXPECT_EQ(fake_.uploads(), 0);
    EXPECT_FALSE(fake_.programRuns());
}

TEST_F(ArmTest, HoldsAfterTheEndAndTakesTheNextSourceWithoutAnotherUpload) {
    openReady();
    const double start = arm().state().commanded_position[0];
    EXPECT_EQ(attach(0.1, 20)->outcome(), EndCause::done);
    EXPECT_EQ(attach(-0.1, 20)->outcome(), EndCause::done);
    EXPECT_EQ(fake_.uploads(), 1);
    EXPECT_TRUE(fake_.programRuns());
    EXPECT_NEAR(arm().state().commanded_position[0], start, 1e-9);
}

TEST_F(ArmTest, StopsAtStandstillAndEndsItsScript) {
    openReady();
    auto source = moving();
    arm().stop();
    EXPECT_EQ(source->outcome(), EndCause::stopped);
    EXPECT_TRUE(arm().state().standstill);
    EXPECT_FALSE(fake_.programRuns());
    EXPECT_EQ(arm().safety().state, SafetyState::normal);
    EXPECT_EQ(attach(0.1, 20)->outcome(), EndCause::done);
    EXPECT_EQ(fake_.uploads(), 2);
}

TEST_F(ArmTest, StopBeforeTheScriptRunsEndsToo) {
    fake_.set([](auto& k) { k.starts = false; });
    openReady();
    auto source = attach(0.1, 20);
    ASSERT_TRUE(fake_.await([&] { return fake_.uploads() == 1; }));
    arm().stop();
    EXPECT_EQ(source->outcome(), EndCause::stopped);
    EXPECT_EQ(source->asked(), 0);
}

TEST_F(ArmTest, RefusesASecondSource) {
    openReady();
    auto source = moving();
    const auto second = arm().attach(std::make_shared<MovingSource>(0.1, 10));
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().code, Errc::resource_unavailable);
    arm().stop();
    EXPECT_EQ(source->outcome(), EndCause::stopped);
}

TEST_F(ArmTest, TheCycleDoesNotAllocate) {
    openReady();
    auto source = attach(0.5, 200);
    EXPECT_EQ(source->outcome(), EndCause::done);
    EXPECT_EQ(source->allocations(), 0U);
}

TEST_F(ArmTest, TheWatchOfAllocationsWorks) {
    const auto before = allocationCount();
    const auto something = std::make_unique<int>(1);
    EXPECT_EQ(allocationCount() - before, 1U);
    EXPECT_EQ(*something, 1);
}

TEST_F(ArmTest, TellsTheSourceWhenTheDriverIsShutDown) {
    openReady();
    auto source = moving();
    device_ = {};
    EXPECT_EQ(source->outcome(), EndCause::disconnected);
    EXPECT_EQ(source->ends(), 1);
}

TEST_F(ArmTest, TakesTheTokenAwayWhenItIsShutDown) {
    openReady();
    auto source = moving();
    device_ = {};
    const auto noToken = [&] {
        const auto input = fake_.lastInput();
        return input.size() == 57 &&
               std::all_of(input.begin() + 1, input.begin() + 5,
                           [](std::byte byte) { return byte == std::byte{0}; });
    };
    EXPECT_TRUE(fake_.await(noToken));
    EXPECT_TRUE(fake_.await([&] { return fake_.paused(); }));
}

TEST_F(ArmTest, CountsTheCyclesThatDidNotCome) {
    openReady();
    const auto before = arm().state();
    fake_.set([](auto& k) { k.skip_cycles = 3; });
    ASSERT_TRUE(
        fake_.await([&] { return arm().state().missed_cycles >= before.missed_cycles + 3; }));
    EXPECT_LT(arm().state().missed_cycles, before.missed_cycles + 6);
}

TEST_F(ArmTest, MayMoveInReducedMode) {
    fake_.set([](auto& k) { k.safety_mode = 2; });
    openReady();
    EXPECT_EQ(attach(0.1, 20)->outcome(), EndCause::done);
}

TEST_F(ArmTest, UsesTheKinematicsAndLimitsThatTheControllerTells) {
    fake_.set([](auto& k) {
        k.a[1] = -0.4262;
        k.max_velocity = 1.0;
    });
    open();
    ASSERT_TRUE(device_.model);
    EXPECT_EQ(device_.model->name(), "ur5");
    EXPECT_FALSE(device_.model->capsules().empty());
    const auto& home = model_.home();
    EXPECT_GT(motion::distanceBetween(device_.model->kinematics().forward(home),
                                      model_.kinematics().forward(home)),
              1e-3);
    EXPECT_NEAR(device_.model->limits(0).velocity, 180.0 / 191.0, 1e-9);
    ASSERT_TRUE(becomes(SafetyState::normal));
    EXPECT_EQ(arm().safety().text, "");
}

TEST_F(ArmTest, FindsItsWayWithOlderSoftware) {
    fake_.set([](auto& k) { k.unknown = {"safety_status", "target_speed_fraction"}; });
    openReady();
    EXPECT_EQ(attach(0.1, 20)->outcome(), EndCause::done);
    fake_.set([](auto& k) { k.safety_mode = 7; });
    EXPECT_TRUE(becomes(SafetyState::emergency_stop));
}

}  // namespace
}  // namespace metier::ur_driver
