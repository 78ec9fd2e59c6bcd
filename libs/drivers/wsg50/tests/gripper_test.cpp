#include <gmock/gmock.h>

#include <future>
#include <memory>

#include "fake_gripper.hpp"
#include "metier/device/reset_slot.hpp"
#include "wsg50_gripper.hpp"

namespace metier::wsg50_driver::testing {
namespace {

using namespace std::chrono_literals;
using device::SafetyState;
using ::testing::AnyOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

/// The changes of a gripper's safety, waited for.
class SafetyWatch {
public:
    explicit SafetyWatch(Wsg50Gripper& gripper)
        : gripper_(gripper),
          registration_(gripper.onSafetyChange([bell = bell_](const device::Safety&) {
              const std::lock_guard lock(bell->mutex);
              bell->changed.notify_all();
          })) {}

    bool reaches(SafetyState state) {
        std::unique_lock lock(bell_->mutex);
        const auto deadline = std::chrono::steady_clock::now() + 10s;
        // Of state(), which follows safety(): both have the state then.
        while (gripper_.state().safety != state) {
            if (std::chrono::steady_clock::now() > deadline) {
                return false;
            }
            bell_->changed.wait_for(lock, 20ms);  // at the latest, since it may have rung before
        }
        return true;
    }

    bool tells(const std::string& text) {
        std::unique_lock lock(bell_->mutex);
        const auto told = [&] { return gripper_.safety().text.find(text) != std::string::npos; };
        const auto deadline = std::chrono::steady_clock::now() + 10s;
        while (!told() && std::chrono::steady_clock::now() < deadline) {
            bell_->changed.wait_for(lock, 20ms);
        }
        return told();
    }

private:
    struct Bell {
        std::mutex mutex;
        std::condition_variable changed;
    };

    Wsg50Gripper& gripper_;
    // Shared with a callback that may still run when the registration has ended.
    std::shared_ptr<Bell> bell_ = std::make_shared<Bell>();
    device::Registration registration_;
};

class Gripper : public ::testing::Test {
protected:
    Gripper() {
        // A busy machine is no silent gripper, nor one whose state does not follow its replies.
        options.conversation.silence_periods = 500;
        options.conversation.reply_timeout = 10s;
        options.conversation.settle_timeout = 10s;
    }

    void connect(const FakeGripper::State& state = {}) {
        fake.set(state);
        options.name = "tool";
        options.host = "127.0.0.1";
        options.port = fake.port();
        gripper = std::make_unique<Wsg50Gripper>(options);
        watch = std::make_unique<SafetyWatch>(*gripper);
    }

    void connectReady() {
        connect();
        ASSERT_TRUE(watch->reaches(SafetyState::normal)) << gripper->safety().text;
    }

    using Ask = Result<void> (device::Gripper::*)(const device::GripperRequest&,
                                                  device::Gripper::Done);

    /// Asks for a motion; its outcome comes through `outcome`.
    Result<void> ask(Ask what, const device::GripperRequest& request = {}) {
        auto promise = std::make_shared<std::promise<Result<device::GripperOutcome>>>();
        outcome = promise->get_future();
        return (gripper.get()->*what)(request, [promise](auto end) { promise->set_value(end); });
    }

    Result<device::GripperOutcome> ended() {
        return outcome.wait_for(10s) == std::future_status::ready
                   ? outcome.get()
                   : Result<device::GripperOutcome>(fail(Errc::internal, "never ended"));
    }

    static constexpr Ask kGraspIt = &device::Gripper::grasp;
    static constexpr Ask kReleaseIt = &device::Gripper::release;
    static constexpr Ask kMoveIt = &device::Gripper::move;

    FakeGripper fake;
    Wsg50Options options;
    std::unique_ptr<Wsg50Gripper> gripper;
    std::unique_ptr<SafetyWatch> watch;
    std::future<Result<device::GripperOutcome>> outcome;

    void TearDown() override { watch.reset(); }
};

TEST_F(Gripper, IsReadyWithItsOwnLimits) {
    Bytes data;
    for (const float value : {68.0F, 5.0F, 300.0F, 100.0F, 5000.0F, 5.0F, 60.0F, 60.0F}) {
        data = data + f32(value);
    }
    fake.answer(0x53, reply(0x53, kSuccess, data));
    connectReady();
    EXPECT_NEAR(gripper->info().stroke, 0.068, 1e-9);
    EXPECT_NEAR(gripper->info().max_force, 60, 1e-9);
    EXPECT_NEAR(gripper->state().width, 0.05, 1e-9);
    EXPECT_EQ(gripper->state().safety, SafetyState::normal);
}

TEST_F(Gripper, DoesOneMotionAtATime) {
    connectReady();
    ASSERT_TRUE(ask(kGraspIt, {.width = 0.03, .force = 20}));
    ASSERT_TRUE(fake.got(0x25));
    EXPECT_EQ(ask(kMoveIt, {.width = 0.01}).error().code, Errc::resource_unavailable);
    ASSERT_TRUE(ask(kGraspIt).error().message.starts_with("tool: "));
}

TEST_F(Gripper, TellsThePartItHolds) {
    connectReady();
    ASSERT_TRUE(ask(kGraspIt, {.width = 0.03, .force = 20}));
    ASSERT_TRUE(fake.got(0x25));
    fake.set({kReferenced, kHolding, 30, 20});
    fake.send(reply(0x25, kSuccess));
    const auto end = ended();
    ASSERT_TRUE(end) << end.error().message;
    EXPECT_TRUE(end->part_held);
    EXPECT_TRUE(gripper->state().part_held);
    ASSERT_TRUE(ask(kReleaseIt));
    ASSERT_TRUE(fake.got(0x26));
    fake.set({kReferenced, kIdle, 110, 0});
    fake.send(reply(0x26, kSuccess));
    EXPECT_TRUE(ended());
}

TEST_F(Gripper, GraspsAPartOfAnyWidthUnlessItIsTold) {
    connectReady();
    ASSERT_TRUE(ask(kGraspIt));
    ASSERT_TRUE(fake.got(0x25));
    fake.send(reply(0x25, kBlocked));
    ASSERT_TRUE(fake.got(0x25, 2));
    fake.set({kReferenced, kHolding, 50, 40});
    fake.send(reply(0x25, kSuccess));
    EXPECT_TRUE(ended());
    fake.set({});
    ASSERT_TRUE(ask(kGraspIt, {.width = 0.03}));
    ASSERT_TRUE(fake.got(0x25, 3));
    fake.send(reply(0x25, kBlocked));
    EXPECT_THAT(ended().error().message, HasSubstr("blocked at 50.0 mm"));
}

TEST_F(Gripper, TakesItsSettingsForWhatARequestLeavesOpen) {
    options.speed = 0.2;
    options.grasp_speed = 0.03;
    options.part_width = 0.04;
    options.force = 30;
    options.open_width = 0.09;
    connectReady();
    ASSERT_TRUE(ask(kGraspIt));
    ASSERT_TRUE(fake.got(0x25));
    EXPECT_EQ(fake.command(0x32), frame(0x32, f32(30)));
    EXPECT_EQ(fake.command(0x25), frame(0x25, f32(40) + f32(30)));
    fake.send(reply(0x25, kBlocked));
    EXPECT_THAT(ended().error().message, HasSubstr("blocked at 50.0 mm"))
        << "the part's width is known: it is not grasped at another one";
    ASSERT_TRUE(ask(kReleaseIt));
    ASSERT_TRUE(fake.got(0x26));
    EXPECT_EQ(fake.command(0x26), frame(0x26, f32(90) + f32(200)));
    fake.send(reply(0x26, kAborted));
    EXPECT_FALSE(ended());
    ASSERT_TRUE(ask(kReleaseIt, {.width = 0.05, .force = 12, .speed = 0.1}));
    ASSERT_TRUE(fake.got(0x26, 2));
    EXPECT_EQ(fake.command(0x32), frame(0x32, f32(12)));
    EXPECT_EQ(fake.command(0x26), frame(0x26, f32(50) + f32(100)));
}

TEST_F(Gripper, OpensAsFarAsItCanUnlessItIsTold) {
    connectReady();
    ASSERT_TRUE(ask(kReleaseIt));
    ASSERT_TRUE(fake.got(0x26));
    EXPECT_EQ(fake.command(0x26), frame(0x26, f32(110) + f32(100)));
}

TEST_F(Gripper, TakesTheForceLimitThatItFoundWithinItsLimits) {
    for (const auto& [found, taken] : {std::pair{40.0F, 40.0F}, {200.0F, 80.0F}, {2.0F, 5.0F}}) {
        watch.reset();
        gripper.reset();
        fake.answer(0x33, reply(0x33, kSuccess, f32(found)));
        connectReady();
        const auto before = fake.ids();
        const auto motions = std::count(before.begin(), before.end(), 0x21);
        ASSERT_TRUE(ask(kMoveIt, {.width = 0.02}));
        ASSERT_TRUE(fake.got(0x21, static_cast<int>(motions) + 1));
        EXPECT_EQ(fake.command(0x32), frame(0x32, f32(taken)));
    }
}

TEST_F(Gripper, TellsThatThereWasNoPart) {
    connectReady();
    ASSERT_TRUE(ask(kGraspIt));
    ASSERT_TRUE(fake.got(0x25));
    fake.set({kReferenced, kNoPart, 0, 0});
    fake.send(reply(0x25, kFailed));
    EXPECT_EQ(ended().error().message, "tool: no part found: the jaws closed to 0.0 mm");
}

TEST_F(Gripper, StopsAMotion) {
    fake.answer(0x22, reply(0x22, kSuccess) + reply(0x21, kAborted));
    connectReady();
    ASSERT_TRUE(ask(kMoveIt, {.width = 0.01}));
    ASSERT_TRUE(fake.got(0x21));
    gripper->stop();
    EXPECT_EQ(ended().error().code, Errc::cancelled);
}

TEST_F(Gripper, StopsAMotionThatWasAskedForAMomentAgo) {
    fake.answer(0x22, reply(0x22, kSuccess) + reply(0x21, kAborted));
    connectReady();
    ASSERT_TRUE(ask(kMoveIt, {.width = 0.01}));
    gripper->stop();
    EXPECT_EQ(ended().error().code, Errc::cancelled);
    EXPECT_TRUE(ask(kMoveIt, {.width = 0.02})) << "the stop was not meant for the next motion";
    EXPECT_TRUE(fake.got(0x21));
}

TEST_F(Gripper, CanBeAskedAgainFromTheEndOfAMotion) {
    connectReady();
    std::promise<Result<void>> again;
    ASSERT_TRUE(gripper->move({.width = 0.01}, [&](const auto&) {
        again.set_value(gripper->move({.width = 0.02}, [](const auto&) {}));
    }));
    ASSERT_TRUE(fake.got(0x21));
    fake.send(reply(0x21, kBlocked));
    auto answer = again.get_future();
    ASSERT_EQ(answer.wait_for(10s), std::future_status::ready);
    EXPECT_TRUE(answer.get());
    watch.reset();
    gripper.reset();  // before what its callbacks use
}

TEST_F(Gripper, RefusesWhatItCannotDoWithValueLimitAndUnit) {
    connectReady();
    EXPECT_EQ(ask(kMoveIt, {.width = 0.2}).error().message,
              "tool: width 0.2 m is not within 0 to 0.11 m");
    EXPECT_THAT(ask(kGraspIt, {.force = 500}).error().message,
                HasSubstr("force 500 N is not within 5 to 80 N"));
    EXPECT_THAT(ask(kReleaseIt, {.speed = 1}).error().message, HasSubstr("m/s"));
    EXPECT_THAT(ask(kReleaseIt, {.width = std::nan("")}).error().code, Errc::out_of_range);
    EXPECT_EQ(ask(kMoveIt).error().code, Errc::invalid_argument);
}

TEST_F(Gripper, IsDisconnectedWithoutOneAndTellsWhere) {
    options.name = "tool";
    options.host = "127.0.0.1";
    options.port = 1;
    gripper = std::make_unique<Wsg50Gripper>(options);
    watch = std::make_unique<SafetyWatch>(*gripper);
    EXPECT_EQ(ask(kGraspIt).error().code, Errc::connection_lost);
    EXPECT_EQ(gripper->resetFault().error().code, Errc::connection_lost);
    EXPECT_EQ(gripper->state().safety, SafetyState::disconnected);
    EXPECT_TRUE(watch->tells("tool: 127.0.0.1:1: Connection refused"));
}

TEST_F(Gripper, WhoseUpdateMakesNoSenseIsLostAndFoundAgain) {
    connectReady();
    fake.silence(true);  // the next connection does not get as far as normal
    fake.send(reply(0x43, kSuccess, bytes({1, 2})));
    ASSERT_TRUE(watch->tells(": width: 2 bytes, expected 4")) << gripper->safety().text;
    EXPECT_THAT(gripper->safety().text, HasSubstr("tool: 127.0.0.1:"));
    ASSERT_TRUE(fake.connections(2));
    fake.silence(false);
    EXPECT_TRUE(watch->reaches(SafetyState::normal));
}

TEST_F(Gripper, ThatIsLostWhileIdleIsFoundAgainInAFault) {
    connectReady();
    fake.set({kReferenced | kFastStop, kIdle, 50, 0});
    fake.drop();
    ASSERT_TRUE(fake.connections(2));
    ASSERT_TRUE(watch->reaches(SafetyState::fault));
    EXPECT_THAT(gripper->safety().text, HasSubstr("tool: fast stop"));
    EXPECT_EQ(ask(kGraspIt).error().code, Errc::device_fault);
    EXPECT_THAT(fake.ids(), Not(Contains(AnyOf(0x20, 0x21, 0x24, 0x25, 0x26))));
}

TEST_F(Gripper, ThatIsLostInAMotionEndsItAndNeverRepeatsIt) {
    connectReady();
    ASSERT_TRUE(ask(kMoveIt, {.width = 0.01}));
    ASSERT_TRUE(fake.got(0x21));
    fake.drop();
    const auto end = ended();
    EXPECT_EQ(end.error().code, Errc::connection_lost);
    EXPECT_THAT(end.error().message, HasSubstr("tool: 127.0.0.1:"));
    ASSERT_TRUE(fake.connections(2));
    ASSERT_TRUE(watch->reaches(SafetyState::normal));
    const auto ids = fake.ids();
    EXPECT_EQ(std::count(ids.begin(), ids.end(), 0x21), 1);
}

TEST_F(Gripper, ThatIsLostDuringHomingMustBeResetAgain) {
    connect({0, kIdle, 50, 0});
    ASSERT_TRUE(watch->reaches(SafetyState::fault));
    auto reset = std::async(std::launch::async, [&] { return gripper->resetFault(); });
    ASSERT_TRUE(fake.got(0x20));
    fake.drop();
    const auto asked = reset.get();
    ASSERT_FALSE(asked);
    EXPECT_TRUE(asked.error().code == Errc::connection_lost || asked.error().code == Errc::timeout);
    ASSERT_TRUE(fake.connections(2));
    ASSERT_TRUE(watch->reaches(SafetyState::fault));
    const auto ids = fake.ids();
    EXPECT_EQ(std::count(ids.begin(), ids.end(), 0x20), 1) << "it does not move by itself";
}

TEST_F(Gripper, ThatFallsSilentIsDisconnected) {
    options.conversation.silence_periods = 10;
    connect();
    ASSERT_TRUE(watch->reaches(SafetyState::normal));
    fake.silence(true);
    ASSERT_TRUE(watch->tells("no update of the")) << gripper->safety().text;
    EXPECT_EQ(gripper->safety().state, SafetyState::disconnected);
    fake.silence(false);
    EXPECT_TRUE(watch->reaches(SafetyState::normal));
}

TEST_F(Gripper, TakesBytesOneByOneAndSkipsBrokenFrames) {
    auto broken = reply(0x43, kSuccess, f32(1));
    broken.back() ^= std::byte{1};
    connectReady();
    fake.send(broken + bytes({0xAA, 0xAA}));
    ASSERT_TRUE(ask(kMoveIt, {.width = 0.05}));
    ASSERT_TRUE(fake.got(0x21));
    fake.send(reply(0x21, kSuccess));
    EXPECT_TRUE(ended());
}

TEST_F(Gripper, IsResetFromAFastStop) {
    connect({kReferenced | kFastStop, kIdle, 50, 0});
    ASSERT_TRUE(watch->reaches(SafetyState::fault));
    auto reset = std::async(std::launch::async, [&] { return gripper->resetFault(); });
    ASSERT_TRUE(fake.got(0x24));
    fake.set({});
    EXPECT_TRUE(watch->reaches(SafetyState::normal));
    const auto asked = reset.get();
    EXPECT_TRUE(asked || asked.error().code == Errc::timeout) << asked.error().message;
    EXPECT_TRUE(gripper->resetFault()) << "of a healthy one does nothing";
}

TEST_F(Gripper, TellsWhyAResetFailedWhenItIsAskedAgain) {
    fake.answer(0x24, reply(0x24, kAccessDenied));
    connect({kReferenced | kFastStop, kIdle, 50, 0});
    ASSERT_TRUE(watch->reaches(SafetyState::fault));
    EXPECT_EQ(gripper->resetFault().error().code, Errc::timeout) << "under way";
    const auto deadline = std::chrono::steady_clock::now() + 10s;
    auto reset = gripper->resetFault();
    while (!reset && reset.error().code == Errc::timeout &&
           std::chrono::steady_clock::now() < deadline) {
        reset = gripper->resetFault();
    }
    ASSERT_FALSE(reset);
    EXPECT_EQ(reset.error().code, Errc::device_fault);
    EXPECT_THAT(reset.error().message, HasSubstr("tool: the gripper refused to acknowledge"));
}

TEST_F(Gripper, TellsThatItHomesAndHoldsUpNobodyWhoAsksForAReset) {
    connect({0, kIdle, 50, 0});
    ASSERT_TRUE(watch->reaches(SafetyState::fault));
    auto shortest = std::chrono::nanoseconds::max();
    for (int i = 0; i < 5; ++i) {  // one of them is not held up by other work of the machine
        const auto before = std::chrono::steady_clock::now();
        const auto reset = gripper->resetFault();
        shortest = std::min(shortest, std::chrono::steady_clock::now() - before);
        ASSERT_FALSE(reset);
        EXPECT_EQ(reset.error().code, Errc::timeout);
        EXPECT_THAT(reset.error().message, HasSubstr("; Reset again"));
    }
    EXPECT_LT(shortest, 20ms) << "a server's thread asks";
    ASSERT_TRUE(fake.got(0x20));
    const auto deadline = std::chrono::steady_clock::now() + 10s;
    while (gripper->safety().text.find("homing: the jaws move") == std::string::npos) {
        ASSERT_LT(std::chrono::steady_clock::now(), deadline) << gripper->safety().text;
    }
    fake.set({kReferenced, kIdle, 110, 0});
    fake.send(reply(0x20, kSuccess));
    ASSERT_TRUE(watch->reaches(SafetyState::normal));
    EXPECT_TRUE(gripper->resetFault());
}

TEST_F(Gripper, HomesOnTheFirstConnectionOnlyIfToldTo) {
    options.conversation.home = true;
    connect({0, kIdle, 50, 0});
    ASSERT_TRUE(fake.got(0x20));
    fake.set({kReferenced, kIdle, 110, 0});
    fake.send(reply(0x20, kSuccess));
    ASSERT_TRUE(watch->reaches(SafetyState::normal));
    fake.set({0, kIdle, 110, 0});
    fake.drop();
    ASSERT_TRUE(fake.connections(2));
    ASSERT_TRUE(watch->reaches(SafetyState::fault));
    const auto ids = fake.ids();
    EXPECT_EQ(std::count(ids.begin(), ids.end(), 0x20), 1);
}

TEST_F(Gripper, TakesItsLeave) {
    connectReady();
    ASSERT_TRUE(ask(kMoveIt, {.width = 0.01}));
    ASSERT_TRUE(fake.got(0x21));
    watch.reset();
    gripper.reset();
    EXPECT_EQ(ended().error().code, Errc::connection_lost);
    ASSERT_TRUE(fake.got(0x07));
    EXPECT_TRUE(fake.got(0x22)) << "the motion is stopped before";
}

TEST_F(Gripper, KeepsTheForceOfTheGripperForMotionsThatAskForNone) {
    connectReady();
    ASSERT_TRUE(ask(kGraspIt));
    EXPECT_TRUE(fake.got(0x32)) << "set before each motion, since it stays";
}

}  // namespace
}  // namespace metier::wsg50_driver::testing
