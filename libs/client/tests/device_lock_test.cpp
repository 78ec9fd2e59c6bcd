// Runs of Programs that name no executions, and whose device has a lock of OPC 10000-100.
#include <gmock/gmock.h>

#include <future>
#include <memory>

#include "device_lock.hpp"
#include "metier/client/async_skill.hpp"
#include "metier/client/skill_handle.hpp"
#include "served_lamps.hpp"

namespace metier::client {
namespace {

using namespace std::chrono_literals;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::LockedDevice;
using ::testing::Not;

SteadyTime in(std::chrono::milliseconds time) {
    return std::chrono::steady_clock::now() + time;
}

TEST_F(LockedDevice, IsLockedFromTheFirstWriteToTheEnd) {
    addLock();
    auto lamp = open("Left");
    EXPECT_TRUE(lamp.locksDevice());
    auto run = std::async(std::launch::async, [&] { return lamp.run({{"Level", 5.0}}, in(10s)); });
    ASSERT_TRUE(calls_.await("Left Start 5", 1));
    EXPECT_THAT(calls_.all(), ElementsAre("InitLock", "Left Start 5"));
    end("Left");
    const auto result = run.get();
    ASSERT_TRUE(result) << result.error().message;
    EXPECT_THAT(calls_.all(), ElementsAre("InitLock", "Left Start 5", "Left End", "ExitLock"));
}

TEST_F(LockedDevice, ThatAnotherClientHasLockedIsNotStartedAndSaysWhose) {
    addLock();
    auto lamp = open("Left");
    lock_status_ = -1;
    const auto refused = lamp.run({{"Level", 5.0}}, in(10s));
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::locked);
    EXPECT_EQ(refused.error().message,
              "Left was not started: the device Light is locked by \"the panel\"");
    EXPECT_THAT(calls_.all(), ElementsAre("InitLock"));
    lock_status_ = 0;
    ASSERT_TRUE(lamp.startWith({.parameters = {{"Level", 6.0}}})) << "it is asked again";
    EXPECT_THAT(calls_.all(), ElementsAre("InitLock", "InitLock", "Left Start 6"));
}

TEST_F(LockedDevice, ThatCannotBeLockedSaysWithWhichStatus) {
    addLock();
    auto lamp = open("Left");
    lock_status_ = -2;
    const auto refused = lamp.run({}, in(10s));
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr("Light refused InitLock with status -2"));
}

TEST_F(LockedDevice, StaysLockedByRenewals) {
    addLock(Lock::implemented, 200.0);
    auto lamp = open("Left");
    ASSERT_TRUE(lamp.startWith({}));
    EXPECT_TRUE(calls_.await("RenewLock", 3));
    EXPECT_THAT(calls_.all(), Not(Contains("ExitLock")));
    end("Left");
    ASSERT_TRUE(lamp.awaitEnd(in(10s)));
    EXPECT_EQ(calls_.all().back(), "ExitLock");
}

TEST_F(LockedDevice, IsGivenBackWhenStartIsRefused) {
    addLock();
    auto lamp = open("Left");
    refuses_start_ = true;
    ASSERT_FALSE(lamp.run({}, in(10s)));
    EXPECT_THAT(calls_.all(), ElementsAre("InitLock", "Left Start 0", "ExitLock"));
}

TEST_F(LockedDevice, IsGivenBackAfterTheHaltOfARunThatTakesTooLong) {
    addLock();
    auto lamp = open("Left");
    ASSERT_FALSE(lamp.run({}, in(50ms)));
    EXPECT_THAT(calls_.all(), ElementsAre("InitLock", "Left Start 0", "Left Halt", "ExitLock"));
}

TEST_F(LockedDevice, IsGivenBackByAHandleThatEnds) {
    addLock();
    {
        auto lamp = open("Left");
        ASSERT_TRUE(lamp.startWith({}));
    }
    EXPECT_TRUE(calls_.await("ExitLock", 1));
}

TEST_F(LockedDevice, WithALockThatIsNotImplementedRunsWithout) {
    addLock(Lock::bare);
    auto lamp = open("Left");
    ASSERT_TRUE(lamp.startWith({.parameters = {{"Level", 5.0}}}));
    end("Left");
    EXPECT_TRUE(lamp.awaitEnd(in(10s)));
    EXPECT_THAT(calls_.all(), ElementsAre("Left Start 5", "Left End"));
}

TEST_F(LockedDevice, WithoutALockIsSaidNotToBeLocked) {
    EXPECT_FALSE(open("Left").locksDevice());
}

/// Two skills that an owner runs who must not wait.
class SharedDeviceLock : public LockedDevice {
protected:
    SharedDeviceLock() { addLock(); }

    AsyncSkill openAsync(const std::string& lamp) {
        return std::move(
            AsyncSkill::open(served_.client(), lamps_.at(lamp).address, {}, locks()).value());
    }
    std::shared_ptr<DeviceLocks> locks() {
        if (!locks_) {
            locks_ = std::make_shared<DeviceLocks>(served_.client());
        }
        return locks_;
    }
    static opcua::Answer<std::string> start(const AsyncSkill& skill) {
        std::promise<opcua::Answer<std::string>> promise;
        const auto sent =
            skill.startWith({.execution_id = "here/1", .parameters = {{"Level", 1.0}}},
                            [&](const auto& answer) { promise.set_value(answer); });
        return sent ? promise.get_future().get() : tl::unexpected(sent.error());
    }

    std::shared_ptr<DeviceLocks> locks_;
};

TEST_F(SharedDeviceLock, LastsUntilBothSkillsAreOver) {
    const auto left = openAsync("Left");
    const auto right = openAsync("Right");
    ASSERT_TRUE(start(left));
    ASSERT_TRUE(start(right));
    left.unlock();
    left.unlock();  // it has ended its use
    EXPECT_THAT(calls_.all(), ElementsAre("InitLock", "Left Start 1", "Right Start 1"));
    right.unlock();
    EXPECT_TRUE(calls_.await("ExitLock", 1));
}

TEST_F(SharedDeviceLock, IsTakenAgainByAStartThatComesWhileItIsGivenBack) {
    const auto left = openAsync("Left");
    const auto right = openAsync("Right");
    ASSERT_TRUE(start(left));
    left.unlock();
    ASSERT_TRUE(start(right));
    EXPECT_THAT(calls_.all(),
                ElementsAre("InitLock", "Left Start 1", "ExitLock", "InitLock", "Right Start 1"));
}

TEST_F(SharedDeviceLock, ThatAnotherClientHasRefusesTheStart) {
    const auto left = openAsync("Left");
    EXPECT_TRUE(left.locksDevice());
    lock_status_ = -1;
    const auto refused = start(left);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::locked);
    EXPECT_EQ(refused.error().message, "the device Light is locked by \"the panel\"");
    left.unlock();
    EXPECT_THAT(calls_.all(), ElementsAre("InitLock")) << "there is nothing to give back";
}

TEST_F(SharedDeviceLock, IsGivenBackWhenStartIsRefused) {
    const auto left = openAsync("Left");
    refuses_start_ = true;
    ASSERT_FALSE(start(left));
    EXPECT_TRUE(calls_.await("ExitLock", 1));
}

}  // namespace
}  // namespace metier::client
