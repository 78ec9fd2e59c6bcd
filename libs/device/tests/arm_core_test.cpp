#include "metier/device/arm_core.hpp"

#include <gmock/gmock.h>

#include <atomic>
#include <functional>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace metier::device {
namespace {

using namespace std::chrono_literals;

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class Source final : public SetPointSource {
public:
    Next next(const ArmState&, JointArray&) noexcept override { return Next::done; }
    void ended(EndCause cause, const Safety& safety) override {
        causes.push_back(cause);
        last = safety;
    }

    std::vector<EndCause> causes;
    Safety last;
};

struct Core : ::testing::Test {
    Core() { core.setSafety({}); }

    ArmCore core{{"robot", {"one", "two"}, std::chrono::milliseconds(8)}};
    std::shared_ptr<Source> source = std::make_shared<Source>();
};

TEST(ArmCore, IsDisconnectedAtFirst) {
    ArmCore core({"robot", {"one", "two"}, std::chrono::milliseconds(8)});
    EXPECT_EQ(core.safety().state, SafetyState::disconnected);
    EXPECT_EQ(core.state().position.size(), 2U);
    const auto refused = core.attach(std::make_shared<Source>());
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::device_fault);
    EXPECT_THAT(refused.error().message, HasSubstr("robot: not connected yet"));
}

TEST_F(Core, LetsOneSourceMoveTheArm) {
    ASSERT_TRUE(core.attach(source));
    EXPECT_EQ(core.active(), source.get());
    const auto second = core.attach(std::make_shared<Source>());
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().code, Errc::resource_unavailable);
}

TEST_F(Core, TellsTheEndOnce) {
    ASSERT_TRUE(core.attach(source));
    core.end(EndCause::done);
    EXPECT_TRUE(core.toTell());
    EXPECT_EQ(core.active(), nullptr);
    EXPECT_TRUE(source->causes.empty()) << "only dispatch() tells";
    core.dispatch();
    core.end(EndCause::stopped);
    core.dispatch();
    EXPECT_THAT(source->causes, ElementsAre(EndCause::done));
    EXPECT_TRUE(core.attach(source));
}

TEST_F(Core, StopsTheSourceThatWasActiveWhenItWasAskedTo) {
    core.stop();
    ASSERT_TRUE(core.attach(source));
    EXPECT_FALSE(core.stopRequested()) << "a stop before the motion does not stop it";
    core.stop();
    EXPECT_TRUE(core.stopRequested());
    EXPECT_TRUE(core.stopRequested());
    core.end(EndCause::stopped);
    core.dispatch();
    ASSERT_TRUE(core.attach(source));
    EXPECT_FALSE(core.stopRequested());
}

TEST_F(Core, ForgetsAStopThatItsMotionEndedBefore) {
    ASSERT_TRUE(core.attach(source));
    core.stop();
    core.end(EndCause::done);  // before the cycle thread looked
    core.dispatch();
    ASSERT_TRUE(core.attach(source)) << "the same source once more";
    EXPECT_FALSE(core.stopRequested());
}

// A text so long that the system gets its memory back at once holds attach() up, first while it
// copies the safety state and then, for a millisecond, between its look at that and the motion's
// begin.
TEST(ArmCore, NeverMovesAnArmThatWasStoppedMeanwhile) {
    const std::string long_text(40'000'000, 'x');  // NOLINT(bugprone-string-constructor)
    for (int round = 0; round < 3; ++round) {
        ArmCore core({"robot", {"one"}, std::chrono::milliseconds(8)});
        core.setSafety({SafetyState::normal, long_text});
        const auto source = std::make_shared<Source>();
        std::atomic<bool> attaching{false};
        std::jthread client([&] {
            attaching.store(true);
            static_cast<void>(core.attach(source));
        });
        while (!attaching.load()) {
            std::this_thread::yield();
        }
        const auto copying = std::chrono::steady_clock::now() + 200us;
        while (std::chrono::steady_clock::now() < copying) {
        }
        core.setSafety({SafetyState::protective_stop, "robot: hit something"});
        core.end(EndCause::safety);
        client.join();
        ASSERT_EQ(core.active(), nullptr) << "round " << round;
        core.dispatch();
    }
}

TEST_F(Core, TellsSafetyOnEachChangeOfState) {
    std::vector<SafetyState> told;
    core.dispatch();
    auto registration = core.onSafetyChange([&](const Safety& s) { told.push_back(s.state); });
    core.setSafety({SafetyState::protective_stop, "robot: hit something"});
    core.setSafety({SafetyState::protective_stop, "robot: hit a wall"});
    core.dispatch();
    EXPECT_EQ(core.safety().text, "robot: hit a wall");
    core.setSafety({});
    core.dispatch();
    registration = {};
    core.setSafety({SafetyState::fault, "robot: broken"});
    core.dispatch();
    EXPECT_THAT(told, ElementsAre(SafetyState::protective_stop, SafetyState::normal));
}

TEST_F(Core, PublishesStatesWithItsSafety) {
    core.setSafety({SafetyState::emergency_stop, "robot: pressed"});
    ArmState state;
    state.cycle = 7;
    core.publish(state);
    EXPECT_EQ(core.state().cycle, 7U);
    EXPECT_EQ(core.state().safety, SafetyState::emergency_stop);
}

TEST_F(Core, TellsASourceThatItsDriverEnds) {
    {
        ArmCore ending({"robot", {"one"}, std::chrono::milliseconds(8)});
        ending.setSafety({});
        ASSERT_TRUE(ending.attach(source));
    }
    EXPECT_THAT(source->causes, ElementsAre(EndCause::disconnected));
}

struct MeasuredCycles : Core {
    void publishAt(std::chrono::microseconds time) {
        ArmState state;
        state.stamp = SteadyTime(std::chrono::seconds(1) + time);
        core.publish(state);
    }
    std::uint64_t count() const {
        const auto counts = core.cycleJitter()->read().counts;
        return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
    }
};

TEST_F(MeasuredCycles, TellHowFarTheyWereOffThePeriod) {
    publishAt(0us);
    publishAt(8'000us);
    publishAt(16'300us);  // 300 us late
    publishAt(24'000us);  // and back
    EXPECT_EQ(count(), 3U);
    EXPECT_NEAR(core.cycleJitter()->read().sum, 600e-6, 1e-9);
}

TEST_F(MeasuredCycles, CountNoPauseOfALostConnection) {
    publishAt(0us);
    core.setSafety({SafetyState::disconnected, "robot: gone"});
    publishAt(8'000us);
    core.setSafety({});
    publishAt(9'000'000us);
    EXPECT_EQ(count(), 0U);
}

TEST_F(MeasuredCycles, CountAStateThatIsPublishedTwiceOnce) {
    publishAt(0us);
    publishAt(8'000us);
    publishAt(8'000us);
    EXPECT_EQ(count(), 1U);
}

TEST_F(Core, HasNothingToStopWhileNobodyMovesTheArm) {
    core.stop();
    EXPECT_FALSE(core.stopRequested());
}

TEST_F(Core, IsStoppedForItsOwnMotionAlone) {
    ASSERT_TRUE(core.attach(source));
    EXPECT_FALSE(core.stopRequested());
    core.stop();
    core.end(EndCause::stopped);
    EXPECT_FALSE(core.stopRequested()) << "nobody moves the arm any more";
}

TEST_F(Core, TellsTheEndWithTheSafetyOfThatMoment) {
    ASSERT_TRUE(core.attach(source));
    core.setSafety({SafetyState::protective_stop, "robot: hit something"});
    core.end(EndCause::safety);
    core.dispatch();
    EXPECT_THAT(source->causes, ElementsAre(EndCause::safety));
    EXPECT_EQ(source->last.state, SafetyState::protective_stop);
    EXPECT_EQ(source->last.text, "robot: hit something");
    EXPECT_EQ(source.use_count(), 1) << "the core has let go of it";
}

TEST_F(Core, TellsALossThatIsOverBeforeItsEndIsTold) {
    core.setSafety({SafetyState::emergency_stop, "robot: pressed long ago"});
    core.setSafety({});
    ASSERT_TRUE(core.attach(source));
    core.setSafety({SafetyState::disconnected, "robot: no joint states for 1000 ms"});
    core.end(EndCause::disconnected);
    core.setSafety({});
    core.dispatch();
    EXPECT_EQ(source->last.text, "robot: no joint states for 1000 ms");

    ASSERT_TRUE(core.attach(source));
    core.end(EndCause::disconnected);
    core.dispatch();
    EXPECT_EQ(source->last.text, "robot: the connection was lost for a moment");
    EXPECT_EQ(source->last.state, SafetyState::disconnected);
}

TEST(SafetyState, HasANameForEach) {
    EXPECT_EQ(toString(SafetyState::normal), "normal");
    EXPECT_EQ(toString(SafetyState::protective_stop), "protective stop");
    EXPECT_EQ(toString(SafetyState::emergency_stop), "emergency stop");
    EXPECT_EQ(toString(SafetyState::fault), "fault");
    EXPECT_EQ(toString(SafetyState::disconnected), "disconnected");
}

/// Does each of them a thousand times, all at the same time.
void together(std::vector<std::function<void()>> all) {
    std::atomic<std::size_t> waiting{all.size()};
    std::vector<std::jthread> threads;
    for (auto& one : all) {
        threads.emplace_back([&waiting, one = std::move(one)] {
            waiting.fetch_sub(1);
            while (waiting.load() > 0) {
                std::this_thread::yield();
            }
            for (int i = 0; i < 1'000; ++i) {
                one();
            }
        });
    }
}

// For the thread sanitizer: a client, the driver's threads and the notifier use it at once.
TEST_F(Core, MayBeUsedByManyThreads) {
    together({[&] { static_cast<void>(core.attach(std::make_shared<Source>())); },
              [&] {
                  core.setSafety({SafetyState::protective_stop, "robot: hit something"});
                  core.end(EndCause::safety);
                  core.setSafety({});
              },
              [&] { core.dispatch(); }, [&] { static_cast<void>(core.safety()); }});
    core.end(EndCause::safety);
    core.dispatch();
    EXPECT_TRUE(core.attach(source));
}

}  // namespace
}  // namespace metier::device
