// The lease and the lock of a controller as clients see them.
#include <gmock/gmock.h>

#include <cmath>
#include <future>

#include "metier/opcua_skill/server_executor.hpp"
#include "metier/skill/control.hpp"
#include "served_skills.hpp"

namespace metier::opcua_skill::testing {
namespace {

using namespace std::chrono_literals;
using opcua::Value;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Arguments = std::vector<Value>;

/// A controller whose control two clients want.
class ControlNodes : public ServedSkills {
protected:
    ControlNodes() {
        EXPECT_TRUE(skills().serveControl(system().controller, control_));
        serve();
        alice_ = connect("alice");
        bob_ = connect("bob");
        lock_ = alice_->translate(system().controller, {{di_, "Lock"}}).value();
    }

    opcua::Answer<opcua::CallResult> callOf(opcua::Client& client, const opcua::NodeId& object,
                                            const opcua::QualifiedName& method,
                                            Arguments arguments) {
        return client.call(object, client.translate(object, {method}).value(),
                           std::move(arguments));
    }
    /// Status of a Method of the lease; the epoch of AcquireControl goes to epoch_.
    std::string lease(opcua::Client& client, const char* method, Arguments arguments) {
        const auto answer =
            callOf(client, system().controller, {metier_, method}, std::move(arguments));
        if (answer && !answer->outputs.empty()) {
            epoch_ = answer->outputs[0].as<std::uint64_t>().value();
        }
        return answer ? "Good" : answer.error().status.name();
    }
    std::string acquire(opcua::Client& client, std::uint32_t lease_ms = 60'000,
                        std::int32_t on_loss = 0) {
        return lease(client, "AcquireControl", {Value::of(lease_ms), Value::of(on_loss)});
    }
    /// Status that a Method of the lock returns.
    int lock(opcua::Client& client, const char* method) {
        auto arguments =
            std::string_view(method) == "InitLock" ? Arguments{Value::of("a test")} : Arguments{};
        const auto answer = callOf(client, lock_, {di_, method}, std::move(arguments));
        return answer ? answer->outputs.at(0).as<std::int32_t>().value() : -99;
    }
    Value shown(const opcua::NodeId& object, const opcua::QualifiedName& name) {
        return bob_->read(bob_->translate(object, {name}).value()).value();
    }
    Value leaseShows(const char* name) { return shown(system().controller, {metier_, name}); }
    Value lockShows(const char* name) { return shown(lock_, {di_, name}); }

    const std::uint16_t metier_ = server().nodes().namespaceIndex("urn:metier:skills").value();
    const std::uint16_t di_ =
        server().nodes().namespaceIndex("http://opcfoundation.org/UA/DI/").value();
    SystemClock clock_;
    std::shared_ptr<skill::Control> control_ =
        std::make_shared<skill::Control>(skills().executor(), clock_);
    std::unique_ptr<opcua::Client> alice_;
    std::unique_ptr<opcua::Client> bob_;
    opcua::NodeId lock_;
    std::uint64_t epoch_ = 0;
};

TEST_F(ControlNodes, ShowNoOwnerAtFirst) {
    EXPECT_EQ(leaseShows("ControlOwner"), Value::of(""));
    EXPECT_EQ(leaseShows("ControlEpoch"), Value::of(std::uint64_t{0}));
    EXPECT_EQ(leaseShows("LeaseRemaining"), Value::of(0.0));
    EXPECT_EQ(lockShows("Locked"), Value::of(false));
    EXPECT_EQ(lockShows("LockingClient"), Value::of(""));
    EXPECT_EQ(lockShows("RemainingLockTime"), Value::of(0.0));
}

TEST_F(ControlNodes, GiveTheLeaseToOneClientAndShowIt) {
    ASSERT_EQ(acquire(*alice_), "Good");
    const auto epoch = epoch_;
    EXPECT_EQ(leaseShows("ControlOwner"), Value::of("alice"));
    EXPECT_EQ(leaseShows("ControlEpoch"), Value::of(epoch));
    const auto remaining = leaseShows("LeaseRemaining").as<double>().value();
    EXPECT_GT(remaining, 0.0);
    EXPECT_LE(remaining, 60'000.0) << "[ms]";
    EXPECT_EQ(acquire(*bob_), "BadLocked");
    EXPECT_EQ(acquire(*alice_), "Good");
    EXPECT_NE(epoch_, epoch) << "a new lease has an epoch of its own";
}

TEST_F(ControlNodes, RenewAndTakeBackTheLeaseForItsEpochAndSessionOnly) {
    ASSERT_EQ(acquire(*alice_), "Good");
    const Arguments own{Value::of(epoch_)};
    const Arguments other{Value::of(epoch_ + 2)};
    EXPECT_EQ(lease(*alice_, "Heartbeat", own), "Good");
    EXPECT_EQ(lease(*alice_, "Heartbeat", other), "BadLocked");
    EXPECT_EQ(lease(*bob_, "Heartbeat", own), "BadLocked");
    EXPECT_EQ(lease(*bob_, "ReleaseControl", own), "BadLocked");
    EXPECT_EQ(lease(*alice_, "ReleaseControl", own), "Good");
    EXPECT_EQ(lease(*alice_, "ReleaseControl", own), "BadLocked") << "it was given back";
    EXPECT_EQ(leaseShows("ControlOwner"), Value::of(""));
    EXPECT_EQ(acquire(*bob_), "Good");
}

TEST_F(ControlNodes, RefuseALeaseBeyondItsLimits) {
    EXPECT_EQ(acquire(*alice_, 99), "BadOutOfRange");
    EXPECT_EQ(acquire(*alice_, 3'600'001), "BadOutOfRange");
    EXPECT_EQ(acquire(*alice_, 60'000, -1), "BadOutOfRange");
    EXPECT_EQ(acquire(*alice_, 60'000, 4), "BadOutOfRange");
    EXPECT_EQ(leaseShows("ControlOwner"), Value::of("")) << "nothing was taken";
    EXPECT_EQ(acquire(*alice_, 3'600'000, 3), "Good");
}

TEST_F(ControlNodes, EndTheLeaseWithItsSession) {
    ASSERT_EQ(acquire(*alice_), "Good");
    ASSERT_TRUE(alice_->close());
    EXPECT_EQ(leaseShows("ControlOwner"), Value::of(""));
    EXPECT_EQ(acquire(*bob_), "Good");
}

TEST_F(ControlNodes, LockForOneClientUntilItUnlocks) {
    EXPECT_EQ(lock(*alice_, "RenewLock"), -1);
    EXPECT_EQ(lock(*alice_, "ExitLock"), -1);
    EXPECT_EQ(lock(*alice_, "BreakLock"), -1);
    ASSERT_EQ(lock(*alice_, "InitLock"), 0);
    EXPECT_EQ(lockShows("LockingClient"), Value::of("alice"));
    EXPECT_EQ(leaseShows("ControlOwner"), Value::of("alice"));
    EXPECT_GT(lockShows("RemainingLockTime").as<double>().value(), 0.0);
    EXPECT_EQ(lock(*alice_, "RenewLock"), 0);
    EXPECT_EQ(lock(*bob_, "RenewLock"), -1);
    EXPECT_EQ(lock(*bob_, "ExitLock"), -1);
    EXPECT_EQ(acquire(*bob_), "BadLocked");
    EXPECT_EQ(lock(*alice_, "ExitLock"), 0);
    EXPECT_EQ(lockShows("Locked"), Value::of(false));
    EXPECT_EQ(acquire(*bob_), "Good");
}

TEST_F(ControlNodes, BreakTheLockButNotTheLease) {
    ASSERT_EQ(lock(*alice_, "InitLock"), 0);
    ASSERT_EQ(acquire(*alice_), "Good");
    EXPECT_EQ(lock(*bob_, "BreakLock"), 0);
    EXPECT_EQ(lockShows("Locked"), Value::of(false));
    EXPECT_EQ(leaseShows("ControlOwner"), Value::of("alice"));
    EXPECT_EQ(lock(*bob_, "InitLock"), -1) << "alice has the lease still";
}

TEST_F(ControlNodes, CannotBeWritten) {
    const auto owner = bob_->translate(system().controller, {{metier_, "ControlOwner"}}).value();
    EXPECT_FALSE(bob_->write(owner, Value::of("bob")));
    EXPECT_EQ(leaseShows("ControlOwner"), Value::of(""));
}

// ---- executor ----------------------------------------------------------------------------------

class ExecutorOfAServer : public ServedSkills {
protected:
    /// Returns once the server's thread has done what it was given before.
    void settle() {
        ASSERT_TRUE(server().call([] {}));
    }

    ServerExecutor executor_{server()};
    std::vector<int> done_;  // by the server's thread
};

TEST_F(ExecutorOfAServer, RunsWorkInItsOrderAndNotWithinTheCall) {
    serve();
    // Both are posted before the first of them can run: the server's thread is in this call.
    ASSERT_TRUE(server().call([this] {
        executor_.post([this] {
            executor_.post([this] { done_.push_back(3); });
            done_.push_back(1);
        });
        executor_.post([this] { done_.push_back(2); });
        EXPECT_THAT(done_, IsEmpty());
    }));
    settle();
    settle();
    EXPECT_THAT(done_, ElementsAre(1, 2, 3));
}

TEST_F(ExecutorOfAServer, RunsWorkLaterUnlessItsTimerHasGone) {
    serve();
    std::promise<void> last;
    skill::Timer kept;
    ASSERT_TRUE(server().call([&] {
        kept = executor_.after(30ms, [&] { last.set_value(); });
        auto dropped = executor_.after(1ms, [this] { done_.push_back(1); });
    }));
    EXPECT_EQ(last.get_future().wait_for(10s), std::future_status::ready);
    ASSERT_TRUE(server().call([&] { kept.cancel(); }));
    EXPECT_THAT(done_, IsEmpty());
}

TEST_F(ExecutorOfAServer, DropsWorkOnceItIsClosed) {
    serve();
    executor_.close();
    executor_.post([this] { done_.push_back(1); });
    auto timer = executor_.after(0ms, [this] { done_.push_back(2); });
    settle();
    EXPECT_THAT(done_, IsEmpty());
    timer.cancel();
}

}  // namespace
}  // namespace metier::opcua_skill::testing
