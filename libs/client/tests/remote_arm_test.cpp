#include "metier/client/remote_arm.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <future>
#include <memory>
#include <thread>

#include "moved_arm.hpp"
#include "served_arm.hpp"

namespace metier::client {
namespace {

using namespace std::chrono_literals;
using device::EndCause;
using device::SafetyState;
using testing::awaitSafety;
using testing::awaitState;
using ::testing::HasSubstr;
using testing::resetUntilDone;
using testing::SmoothMove;
using testing::soon;

/// Looks at the text of the arm's safety until this is in it; false after 30 s. A new text of the
/// same state is not reported.
bool awaitText(const RemoteArm& arm, const std::string& part) {
    const auto deadline = soon();
    while (arm.safety().text.find(part) == std::string::npos) {
        if (std::chrono::steady_clock::now() > deadline) {
            return false;
        }
        std::this_thread::yield();
    }
    return true;
}

TEST(RemoteArm, ReadsWhatTheArmIsLikeFromItsServer) {
    const ServedArm served;
    const auto arm = RemoteArm::connect({.url = served.url()});
    ASSERT_TRUE(arm) << arm.error().message;
    EXPECT_EQ((*arm)->info().axisCount(), 6U);
    EXPECT_EQ((*arm)->info().cycle, 8ms);
    EXPECT_EQ((*arm)->state().position.size(), 6U);
    EXPECT_EQ((*arm)->kinematics().axisCount(), 6U);
}

TEST(RemoteArm, MovesTheArmAndEndsAtStandstill) {
    ServedArm served;
    const auto arm = RemoteArm::connect({.url = served.url()}).value();
    const double start = served.arm().state().position[0];
    // Shared with the arm until it lets go, as device::Arm asks.
    const auto move = std::make_shared<SmoothMove>(0.2, 100);
    ASSERT_TRUE(arm->attach(move));
    ASSERT_EQ(move->awaitEnd(), EndCause::done) << move->text();
    EXPECT_NEAR(served.arm().state().position[0], start + 0.2, 1e-3);
    EXPECT_EQ(served.arm().safety().state, SafetyState::normal);
}

TEST(RemoteArm, ShowsTheStateOfTheEndToWhoeverHearsOfIt) {
    ServedArm served;
    const auto arm = RemoteArm::connect({.url = served.url()}).value();
    for (int i = 0; i < 5; ++i) {
        const auto move = std::make_shared<SmoothMove>(0.05, 30);
        std::promise<bool> standstill;
        move->onEnd([&] { standstill.set_value(arm->state().standstill); });
        ASSERT_TRUE(arm->attach(move));
        ASSERT_EQ(move->awaitEnd(), EndCause::done) << move->text();
        EXPECT_TRUE(standstill.get_future().get()) << "the next motion would be refused";
    }
}

TEST(RemoteArm, LeavesTheArmFreeForOthersWhenItTellsTheEndOfAMotion) {
    ServedArm served;
    const auto arm = RemoteArm::connect({.url = served.url()}).value();
    for (int i = 0; i < 5; ++i) {
        const auto move = std::make_shared<SmoothMove>(0.05, 30);
        const auto own = std::make_shared<SmoothMove>(0.0, 1);
        std::promise<bool> others_may;
        move->onEnd([&] { others_may.set_value(served.arm().attach(own).has_value()); });
        ASSERT_TRUE(arm->attach(move));
        ASSERT_EQ(move->awaitEnd(), EndCause::done) << move->text();
        ASSERT_TRUE(others_may.get_future().get());
        ASSERT_EQ(own->awaitEnd(), EndCause::done);
    }
}

TEST(RemoteArm, StandsAsSoonAsItsServerSaysSo) {
    ServedArm served;
    const auto arm = RemoteArm::connect({.url = served.url()}).value();
    auto shortest = std::chrono::nanoseconds::max();
    for (int i = 0; i < 5; ++i) {  // one of them is not held up by other work of the machine
        const auto own = std::make_shared<SmoothMove>(0.05, 30);
        SteadyTime ended;
        own->onEnd([&] { ended = std::chrono::steady_clock::now(); });
        ASSERT_TRUE(served.arm().attach(own));
        ASSERT_EQ(own->awaitEnd(), EndCause::done);
        ASSERT_TRUE(awaitState(*arm, [&](const device::ArmState& seen) {
            return seen.standstill && seen.position == served.arm().state().position;
        }));
        shortest = std::min(shortest, std::chrono::steady_clock::now() - ended);
    }
    EXPECT_LT(shortest, 150ms) << "without its word it stands after 300 ms";
}

TEST(RemoteArm, MovesAgainAtOnceAndAfterAPause) {
    ServedArm served;
    const auto arm = RemoteArm::connect({.url = served.url()}).value();
    for (const double distance : {0.1, -0.1, 0.1}) {
        const auto move = std::make_shared<SmoothMove>(distance, 60);
        ASSERT_TRUE(arm->attach(move));
        ASSERT_EQ(move->awaitEnd(), EndCause::done) << move->text();
    }
    ASSERT_TRUE(served.awaitStreamEnd());
    const auto move = std::make_shared<SmoothMove>(-0.1, 60);
    ASSERT_TRUE(arm->attach(move));
    EXPECT_EQ(move->awaitEnd(), EndCause::done) << move->text();
}

TEST(RemoteArm, LetsOnlyOneSourceMoveIt) {
    ServedArm served;
    const auto arm = RemoteArm::connect({.url = served.url()}).value();
    const auto first = std::make_shared<SmoothMove>(0.1, 60);
    ASSERT_TRUE(arm->attach(first));
    const auto second = arm->attach(std::make_shared<SmoothMove>(0.1, 60));
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().code, Errc::resource_unavailable);
    EXPECT_EQ(first->awaitEnd(), EndCause::done);
}

TEST(RemoteArm, EndsTheMotionAtAProtectiveStopAndMovesAgainAfterReset) {
    ServedArm served;
    const auto arm = RemoteArm::connect({.url = served.url()}).value();
    std::string text;
    // The machine does not hold up the robot's words of all of them for longer than they are
    // awaited.
    for (int i = 0; i < 5 && text.find("a hand in the light curtain") == std::string::npos; ++i) {
        const auto move = std::make_shared<SmoothMove>(0.5, 500);
        ASSERT_TRUE(arm->attach(move));
        ASSERT_TRUE(served.awaitStreamStart());
        served.arm().protectiveStop("a hand in the light curtain");
        ASSERT_EQ(move->awaitEnd(), EndCause::safety);
        EXPECT_NE(arm->safety().state, SafetyState::normal);
        text = move->text();
        EXPECT_FALSE(arm->attach(std::make_shared<SmoothMove>(0.1, 60)));
        const auto reset = resetUntilDone(*arm);
        ASSERT_TRUE(reset) << reset.error().message;
    }
    EXPECT_THAT(text, HasSubstr("a hand in the light curtain")) << "in the robot's words";
    const auto again = std::make_shared<SmoothMove>(0.1, 60);
    ASSERT_TRUE(arm->attach(again));
    EXPECT_EQ(again->awaitEnd(), EndCause::done) << again->text();
}

TEST(RemoteArm, TellsInTheRobotsWordsWhyItIsStoppedAlsoWhileNothingMovesIt) {
    ServedArm served;
    served.watchDevice();
    const auto arm = RemoteArm::connect({.url = served.url()}).value();
    served.arm().protectiveStop("C153A0: a hand in the light curtain");
    ASSERT_TRUE(awaitSafety(*arm, SafetyState::protective_stop));
    EXPECT_TRUE(awaitText(*arm, "C153A0: a hand in the light curtain"));
    const auto later = RemoteArm::connect({.url = served.url()}).value();
    EXPECT_TRUE(awaitText(*later, "C153A0: a hand in the light curtain"));
    ASSERT_TRUE(resetUntilDone(*arm));
    EXPECT_EQ(arm->safety().text, "");
}

TEST(RemoteArm, HoldsUpNobodyWhoAsksForAResetThatItsServerDoesNotAnswer) {
    ServedArm served;
    const auto arm = RemoteArm::connect({.url = served.url()}).value();
    served.arm().protectiveStop("a hand in the light curtain");
    ASSERT_TRUE(awaitSafety(*arm, SafetyState::protective_stop));
    auto shortest = std::chrono::nanoseconds::max();
    {
        const auto busy = served.keepBusy();
        for (int i = 0; i < 5; ++i) {  // one of them is not held up by other work of the machine
            const auto before = std::chrono::steady_clock::now();
            EXPECT_EQ(arm->resetFault().error().code, Errc::timeout);
            shortest = std::min(shortest, std::chrono::steady_clock::now() - before);
        }
    }
    EXPECT_LT(shortest, 20ms) << "a server's thread asks";
    const auto reset = resetUntilDone(*arm);
    EXPECT_TRUE(reset) << reset.error().message;
}

TEST(RemoteArm, TellsThatItsServerIsGoneAndFindsItAgain) {
    auto served = std::make_unique<ServedArm>();
    const auto url = served->url();
    const auto port = served->port();
    const auto arm = RemoteArm::connect({.url = url, .retry_interval = 20ms}).value();
    const auto move = std::make_shared<SmoothMove>(0.5, 500);
    ASSERT_TRUE(arm->attach(move));
    served.reset();
    ASSERT_EQ(move->awaitEnd(), EndCause::disconnected);
    EXPECT_THAT(arm->safety().text, HasSubstr(url));
    EXPECT_EQ(arm->resetFault().error().code, Errc::connection_lost);
    served = std::make_unique<ServedArm>(port);
    ASSERT_TRUE(awaitSafety(*arm, SafetyState::normal));
    const auto again = std::make_shared<SmoothMove>(0.1, 60);
    ASSERT_TRUE(arm->attach(again));
    EXPECT_EQ(again->awaitEnd(), EndCause::done) << again->text();
}

TEST(RemoteArm, StaysAwayFromAnotherArmAtTheAddressOfTheFormer) {
    auto served = std::make_unique<ServedArm>();
    const auto port = served->port();
    const auto arm = RemoteArm::connect({.url = served->url(), .retry_interval = 20ms}).value();
    EXPECT_FALSE(arm->absence());
    served.reset();
    ASSERT_TRUE(awaitSafety(*arm, SafetyState::disconnected));
    ASSERT_TRUE(arm->absence());
    EXPECT_FALSE(arm->absence()->replaced);
    served = std::make_unique<ServedArm>(port, 0.5);
    ASSERT_TRUE(awaitText(*arm, "publishes other kinematics or limits than before"));
    EXPECT_TRUE(arm->absence()->replaced);
    const auto move = std::make_shared<SmoothMove>(0.1, 60);
    const auto refused = arm->attach(move);
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr("other kinematics"));
    served.reset();
    served = std::make_unique<ServedArm>(port);
    ASSERT_TRUE(awaitSafety(*arm, SafetyState::normal)) << "the former arm is welcome";
    EXPECT_FALSE(arm->absence());
}

TEST(RemoteArm, StopsTheStreamOfItsServer) {
    ServedArm served;
    const auto arm = RemoteArm::connect({.url = served.url()}).value();
    const auto move = std::make_shared<SmoothMove>(0.5, 500);
    ASSERT_TRUE(arm->attach(move));
    ASSERT_TRUE(served.awaitStreamStart());
    arm->stop();
    EXPECT_EQ(move->awaitEnd(), EndCause::stopped);
    ASSERT_TRUE(served.awaitStreamEnd());
    const auto again = std::make_shared<SmoothMove>(0.1, 60);
    ASSERT_TRUE(arm->attach(again));
    EXPECT_EQ(again->awaitEnd(), EndCause::done) << again->text();
}

TEST(RemoteArm, RefusesAServerThatIsNotThere) {
    const auto arm = RemoteArm::connect({.url = "opc.tcp://127.0.0.1:1"});
    ASSERT_FALSE(arm);
    EXPECT_EQ(arm.error().code, Errc::connection_lost);
}

}  // namespace
}  // namespace metier::client
