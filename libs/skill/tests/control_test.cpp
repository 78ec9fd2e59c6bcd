#include "metier/skill/control.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <malloc.h>

#include <set>

#include "metier/skill/testing/manual_executor.hpp"
#include "program_bench.hpp"

namespace metier::skill::testing {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class Losses final : public Control::Listener {
public:
    void onControlLost(std::string_view session, OwnerLossAction action,
                       const std::string& text) override {
        told.push_back(std::string(session) + " " + std::string(toString(action)) + ": " + text);
    }
    std::vector<std::string> told;
};

class Controlled : public ::testing::Test {
protected:
    Controlled() { control.attach(losses); }

    std::shared_ptr<ManualExecutor> executor = std::make_shared<ManualExecutor>();
    Control control{executor, executor->clock()};
    Losses losses;
};

TEST_F(Controlled, KeepsOthersOutWhileTheLeaseLasts) {
    ASSERT_TRUE(control.checkCommand(kBob));
    const auto epoch = control.acquire(kAlice, 500ms, OwnerLossAction::halt);
    ASSERT_TRUE(epoch);
    EXPECT_TRUE(control.checkCommand(kAlice));
    EXPECT_TRUE(control.checkEpoch(kAlice, *epoch));
    const auto refused = control.checkCommand(kBob);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::locked);
    EXPECT_THAT(refused.error().message, HasSubstr("Alice's client"));
    EXPECT_FALSE(control.acquire(kBob, 0ms, OwnerLossAction::halt));
    EXPECT_FALSE(control.lock(kBob));
    EXPECT_FALSE(control.checkEpoch(kBob, *epoch)) << "an epoch is the session's own";
}

TEST_F(Controlled, HasNothingLeftOfALeaseOrLockWhoseTimerIsLate) {
    ManualClock clock;
    Control late(executor, clock);
    ASSERT_TRUE(late.acquire(kAlice, 500ms, OwnerLossAction::halt));
    ASSERT_TRUE(late.lock(kAlice));
    clock.advance(300ms);
    EXPECT_EQ(late.leaseRemaining(), 200ms);
    EXPECT_EQ(late.lockRemaining(), Control::kLockTime - 300ms);
    clock.advance(Control::kLockTime);
    EXPECT_EQ(late.leaseRemaining(), 0ms);
    EXPECT_EQ(late.lockRemaining(), 0ms);
}

TEST_F(Controlled, TellsNoListenerThatHasDetachedItself) {
    Losses gone;
    control.attach(gone);
    control.detach(gone);
    ASSERT_TRUE(control.acquire(kAlice, 500ms, OwnerLossAction::halt));
    control.sessionClosed(kAlice.session_id);
    EXPECT_THAT(gone.told, IsEmpty());
    EXPECT_EQ(losses.told.size(), 1U);
}

// Memory that is given back is overwritten, so that a call of a destroyed object fails.
TEST_F(Controlled, TellsNoProgramThatIsGone) {
    ::mallopt(M_PERTURB, 0xA5);
    const auto shared = std::make_shared<Control>(executor, executor->clock());
    { const ProgramBench gone({.control = shared}, weldDescription(), executor); }
    ::mallopt(M_PERTURB, 0);
    ASSERT_TRUE(shared->acquire(kAlice, 500ms, OwnerLossAction::halt));
    shared->sessionClosed(kAlice.session_id);
    EXPECT_EQ(shared->losses(), 1U);
}

TEST_F(Controlled, LetsASkillOfTheServerRunOthersForWhoeverStartedIt) {
    ASSERT_TRUE(control.acquire(kAlice, 500ms, OwnerLossAction::halt));
    const Caller skill{.session_id = "composition Pick", .of_this_server = true};
    EXPECT_TRUE(control.checkCommand(skill));
    EXPECT_TRUE(control.checkEpoch(skill, 0));
}

TEST_F(Controlled, LosesItWhenTheLeaseRunsOutWithoutAHeartbeat) {
    const auto epoch = control.acquire(kAlice, 500ms, OwnerLossAction::suspend);
    executor->advance(499ms);
    ASSERT_TRUE(control.heartbeat(kAlice, *epoch));
    executor->advance(499ms);
    EXPECT_THAT(losses.told, IsEmpty());
    EXPECT_EQ(control.leaseRemaining(), 1ms);
    executor->advance(1ms);
    EXPECT_THAT(losses.told,
                ElementsAre("alice Suspend: no heartbeat of \"Alice's client\" for 500 ms"));
    EXPECT_FALSE(control.heartbeat(kAlice, *epoch)) << "a stale commander that wakes up";
    EXPECT_FALSE(control.checkEpoch(kAlice, *epoch));
    EXPECT_TRUE(control.acquire(kBob, 0ms, OwnerLossAction::halt));
}

TEST_F(Controlled, ASessionWhoseLeaseRanOutCommandsNothingUntilItTakesControlAnew) {
    ASSERT_TRUE(control.acquire(kAlice, 500ms, OwnerLossAction::halt));
    executor->advance(500ms);
    const auto refused = control.checkCommand(kAlice);
    ASSERT_FALSE(refused) << "a command without an epoch that is late, or of a commander that woke";
    EXPECT_EQ(refused.error().code, Errc::locked);
    EXPECT_THAT(refused.error().message, HasSubstr("has run out"));
    EXPECT_FALSE(control.checkEpoch(kAlice, 0));
    EXPECT_TRUE(control.checkCommand(kBob));
    ASSERT_TRUE(control.acquire(kAlice, 500ms, OwnerLossAction::halt));
    EXPECT_TRUE(control.checkCommand(kAlice));
    executor->advance(500ms);
    ASSERT_TRUE(control.lock(kAlice));
    EXPECT_TRUE(control.checkCommand(kAlice)) << "the lock is control, too";
    control.sessionClosed("alice");
    EXPECT_TRUE(control.checkCommand(kAlice));
}

TEST_F(Controlled, LosesItWithTheSession) {
    ASSERT_TRUE(control.acquire(kAlice, 0ms, OwnerLossAction::skill_default));
    control.sessionClosed("bob");
    EXPECT_THAT(losses.told, IsEmpty());
    control.sessionClosed("alice");
    EXPECT_THAT(losses.told,
                ElementsAre("alice SkillDefault: the session of \"Alice's client\" has ended"));
    EXPECT_TRUE(control.checkCommand(kBob));
    executor->advance(10s);
    EXPECT_THAT(losses.told, ::testing::SizeIs(1));
}

TEST_F(Controlled, GivesItBackWithoutALoss) {
    const auto epoch = control.acquire(kAlice, 0ms, OwnerLossAction::halt);
    EXPECT_FALSE(control.release(kBob, *epoch));
    EXPECT_FALSE(control.release(kAlice, *epoch + 2));
    ASSERT_TRUE(control.release(kAlice, *epoch));
    executor->advance(10s);
    EXPECT_THAT(losses.told, IsEmpty());
    EXPECT_EQ(control.leaseRemaining(), 0ms);
    EXPECT_EQ(executor->timerCount(), 0U);
}

TEST_F(Controlled, RefusesALeaseOutOfRange) {
    for (const auto lease : {1ms, 99ms, 3'600'001ms}) {
        const auto refused = control.acquire(kAlice, lease, OwnerLossAction::halt);
        ASSERT_FALSE(refused);
        EXPECT_EQ(refused.error().code, Errc::out_of_range);
        EXPECT_THAT(refused.error().message, HasSubstr("100 to 3600000 ms"));
    }
    EXPECT_TRUE(control.checkCommand(kBob));
}

TEST_F(Controlled, NeverGivesAnEpochTwiceAlsoAfterARestart) {
    std::set<std::uint64_t> epochs;
    for (int restart = 0; restart < 100; ++restart) {
        Control fresh(executor, executor->clock());
        for (int i = 0; i < 100; ++i) {
            const auto epoch = fresh.acquire(kAlice, 0ms, OwnerLossAction::halt);
            ASSERT_TRUE(epoch);
            ASSERT_NE(*epoch, 0U);
            ASSERT_TRUE(epochs.insert(*epoch).second);
        }
    }
}

TEST_F(Controlled, LockKeepsOthersOutAndIsNoDeadMan) {
    ASSERT_TRUE(control.lock(kAlice));
    EXPECT_FALSE(control.checkCommand(kBob));
    EXPECT_FALSE(control.lock(kBob));
    EXPECT_FALSE(control.unlock(kBob));
    EXPECT_TRUE(control.acquire(kAlice, 0ms, OwnerLossAction::halt))
        << "its holder may take a lease";
    EXPECT_FALSE(control.unlock(kBob));
    ASSERT_TRUE(control.unlock(kAlice));
    EXPECT_FALSE(control.checkCommand(kBob)) << "the lease is still held";
}

TEST_F(Controlled, LockEndsWithoutRenewalWithItsSessionAndWhenBroken) {
    ASSERT_TRUE(control.lock(kAlice));
    executor->advance(59s);
    ASSERT_TRUE(control.renewLock(kAlice));
    executor->advance(59s);
    EXPECT_TRUE(control.isLocked());
    EXPECT_EQ(control.lockRemaining(), 1s);
    executor->advance(1s);
    EXPECT_FALSE(control.isLocked());
    ASSERT_TRUE(control.lock(kBob));
    control.sessionClosed("bob");
    EXPECT_FALSE(control.isLocked());
    EXPECT_FALSE(control.breakLock());
    ASSERT_TRUE(control.lock(kBob));
    EXPECT_TRUE(control.breakLock());
    EXPECT_TRUE(control.checkCommand(kAlice));
    EXPECT_THAT(losses.told, IsEmpty());
}

TEST_F(Controlled, NamesItsHolderAndWhatTheLeaseAsksFor) {
    EXPECT_TRUE(control.holder().session_id.empty());
    EXPECT_FALSE(control.leasedBy("alice"));
    EXPECT_EQ(control.epoch(), 0U);
    ASSERT_TRUE(control.lock(kAlice));
    EXPECT_EQ(control.holder().session_id, "alice");
    EXPECT_EQ(control.locker().session_id, "alice");
    EXPECT_FALSE(control.leasedBy("alice")) << "a lock is no lease";
    ASSERT_TRUE(control.unlock(kAlice));
    const auto epoch = control.acquire(kBob, 0ms, OwnerLossAction::suspend);
    EXPECT_EQ(control.holder().session_id, "bob");
    EXPECT_TRUE(control.leasedBy("bob"));
    EXPECT_FALSE(control.leasedBy("alice"));
    EXPECT_EQ(control.epoch(), *epoch);
    EXPECT_EQ(control.leaseRemaining(), Control::kDefaultLease);
    ASSERT_TRUE(control.release(kBob, *epoch));
    EXPECT_TRUE(control.holder().session_id.empty());
    EXPECT_FALSE(control.leasedBy("bob"));
}

TEST_F(Controlled, TakesTheLeaseFromAShortestToALongest) {
    for (const auto lease : {Control::kShortestLease, Control::kLongestLease}) {
        ASSERT_TRUE(control.acquire(kAlice, lease, OwnerLossAction::halt)) << lease.count();
        EXPECT_EQ(control.leaseRemaining(), lease);
    }
}

TEST_F(Controlled, RefusesWithTheNameOfTheHolder) {
    ASSERT_TRUE(control.lock(kAlice));
    EXPECT_EQ(control.checkCommand(kBob).error().message, "\"Alice's client\" has locked it");
    ASSERT_TRUE(control.acquire(kAlice, 0ms, OwnerLossAction::halt));
    EXPECT_EQ(control.checkCommand(kBob).error().message, "\"Alice's client\" has control of it");
    ASSERT_TRUE(control.breakLock());
    control.sessionClosed("alice");
    ASSERT_TRUE(control.lock({.session_id = "nameless"}));
    EXPECT_EQ(control.checkCommand(kBob).error().message, "a client has locked it");
}

TEST_F(Controlled, IsHeldByNobodyAfterAReleaseByAClientWithoutASession) {
    const Caller nobody;
    EXPECT_FALSE(control.heartbeat(nobody, 0));
    EXPECT_FALSE(control.renewLock(nobody));
    EXPECT_FALSE(control.unlock(nobody));
    EXPECT_FALSE(control.leasedBy(nobody.session_id));
    const auto epoch = control.acquire(nobody, 0ms, OwnerLossAction::halt);
    ASSERT_TRUE(control.heartbeat(nobody, *epoch));
    ASSERT_TRUE(control.release(nobody, *epoch));
    EXPECT_FALSE(control.heartbeat(nobody, *epoch)) << "it was given back";
    control.sessionClosed(nobody.session_id);
    EXPECT_THAT(losses.told, IsEmpty());
}

TEST_F(Controlled, LockIsRenewedAndGivenBackByItsHolderAlone) {
    ASSERT_TRUE(control.lock(kAlice));
    executor->advance(30s);
    EXPECT_EQ(control.renewLock(kBob).error().code, Errc::invalid_state);
    EXPECT_EQ(control.lockRemaining(), 30s);
    EXPECT_EQ(control.unlock(kBob).error().code, Errc::invalid_state);
    control.sessionClosed("bob");
    EXPECT_TRUE(control.isLocked());
    ASSERT_TRUE(control.unlock(kAlice));
    EXPECT_FALSE(control.isLocked());
    EXPECT_TRUE(control.locker().session_id.empty());
    EXPECT_EQ(control.lockRemaining(), 0ms);
    EXPECT_EQ(executor->timerCount(), 0U);
    EXPECT_EQ(control.breakLock().error().code, Errc::invalid_state);
}

TEST_F(Controlled, CountsTheLeasesThatWereLostAndNotThoseGivenBack) {
    const auto epoch = control.acquire(kAlice, 500ms, OwnerLossAction::halt);
    ASSERT_TRUE(control.release(kAlice, *epoch));
    EXPECT_EQ(control.losses(), 0U);
    ASSERT_TRUE(control.acquire(kAlice, 500ms, OwnerLossAction::halt));
    executor->advance(500ms);
    EXPECT_EQ(control.losses(), 1U);
    EXPECT_EQ(executor->timerCount(), 0U);
}

}  // namespace
}  // namespace metier::skill::testing
