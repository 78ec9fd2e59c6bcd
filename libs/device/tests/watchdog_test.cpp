#include "metier/device/watchdog.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <future>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace metier::device {
namespace {

using namespace std::chrono_literals;

constexpr std::chrono::nanoseconds kLimit = 250ms;

/// A clock that the test moves. It stands for every other thread, so that the watchdog's own thread
/// looks in vain.
class TestsClock final : public Clock {
public:
    SteadyTime now() const noexcept override {
        if (std::this_thread::get_id() != test_) {
            return {};
        }
        if (const auto work = std::exchange(meanwhile_, nullptr)) {
            work();
        }
        return clock_.now();
    }
    UtcTime utcNow() const noexcept override { return clock_.utcNow(); }
    void advance(std::chrono::nanoseconds step) noexcept { clock_.advance(step); }
    /// Runs work while somebody asks for the time next.
    void meanwhile(std::function<void()> work) { meanwhile_ = std::move(work); }

private:
    const std::thread::id test_ = std::this_thread::get_id();
    ManualClock clock_;
    mutable std::function<void()> meanwhile_;
};

/// A watched thread, played by the test, like the watchdog's own: only the test looks.
class WatchedThread : public ::testing::Test {
protected:
    WatchedThread() { clock_.advance(1s); }

    Watchdog::Actions actions() {
        return {.stop = [this] { ++stops_; },
                .post = [this](std::function<void()> work) { posted_.push_back(std::move(work)); },
                .tell = [this](std::chrono::nanoseconds stalled) { reported_.push_back(stalled); },
                .noticed = [this](std::chrono::nanoseconds) { ++noticed_; }};
    }

    /// Runs the closures in the watched thread's queue, as when it works again.
    void runPosted() {
        for (const auto& each : std::exchange(posted_, {})) {
            each();
        }
    }

    TestsClock clock_;
    int stops_ = 0;
    int noticed_ = 0;
    std::vector<std::chrono::nanoseconds> reported_;
    std::vector<std::function<void()>> posted_;
    Watchdog watchdog_{actions(), kLimit, clock_};
};

TEST_F(WatchedThread, IsNotWatchedBeforeItsFirstTick) {
    clock_.advance(1h);
    watchdog_.look();
    watchdog_.tick();
    EXPECT_EQ(stops_, 0);
    EXPECT_EQ(noticed_, 0);
}

// It may wake up in the middle of look() and run what was posted at once.
TEST(Stall, IsReportedAsNoticedBeforeTheWatchedThreadReportsItsEnd) {
    ManualClock clock;
    clock.advance(1s);
    std::vector<std::string> order;  // of the watchdog's thread or of this one, until `over`
    std::promise<void> over;
    Watchdog watchdog({.stop = [] {},
                       .post = [](const std::function<void()>& work) { work(); },
                       .tell =
                           [&](std::chrono::nanoseconds) {
                               order.emplace_back("over");
                               over.set_value();
                           },
                       .noticed = [&](std::chrono::nanoseconds) { order.emplace_back("noticed"); }},
                      1h, clock);
    watchdog.tick();
    clock.advance(2h);
    watchdog.look();
    ASSERT_EQ(over.get_future().wait_for(1min), std::future_status::ready);
    EXPECT_EQ(order, (std::vector<std::string>{"noticed", "over"}));
}

TEST_F(WatchedThread, IsLeftAloneWhileItTicksInTime) {
    for (int i = 0; i < 100; ++i) {
        watchdog_.tick();
        clock_.advance(kLimit);
        watchdog_.look();
    }
    watchdog_.tick();
    runPosted();
    EXPECT_EQ(stops_, 0);
    EXPECT_TRUE(reported_.empty());
}

// The watchdog's thread may be held up in the middle of look().
TEST_F(WatchedThread, ThatTicksDuringALookIsLeftAlone) {
    watchdog_.tick();
    clock_.meanwhile([this] {
        clock_.advance(kLimit);
        watchdog_.tick();
        clock_.advance(1ns);
    });
    watchdog_.look();
    EXPECT_EQ(stops_, 0);
    EXPECT_EQ(noticed_, 0);
}

TEST_F(WatchedThread, ThatStallsHasItsDevicesStopped) {
    watchdog_.tick();
    clock_.advance(kLimit + 1ns);
    watchdog_.look();
    EXPECT_EQ(stops_, 1);
    EXPECT_EQ(noticed_, 1);
    EXPECT_TRUE(reported_.empty()) << "nobody is there to be told";
}

TEST_F(WatchedThread, IsLookedAtRightWhenItsLimitIsOver) {
    watchdog_.tick();
    clock_.advance(100ms);
    const auto pause = watchdog_.look();
    EXPECT_GT(pause, 150ms);
    EXPECT_LT(pause, 151ms);
}

TEST_F(WatchedThread, HasItsDevicesStoppedAgainAsLongAsItStalls) {
    watchdog_.tick();
    clock_.advance(kLimit + 1ns);
    watchdog_.look();
    const int before = stops_;
    clock_.advance(1s);
    EXPECT_LE(watchdog_.look(), Watchdog::tickPeriod(kLimit));
    EXPECT_GT(stops_, before) << "what began to move in the last moment is stopped, too";
    EXPECT_EQ(noticed_, 1);
}

TEST_F(WatchedThread, IsToldOnceForHowLongItDidNotWork) {
    watchdog_.tick();
    clock_.advance(kLimit + 1ns);
    watchdog_.look();
    clock_.advance(1s);
    watchdog_.look();
    runPosted();
    watchdog_.tick();
    runPosted();
    ASSERT_EQ(reported_.size(), 1U);
    EXPECT_EQ(reported_[0], kLimit + 1s + 1ns);
    EXPECT_EQ(noticed_, 1);
}

TEST_F(WatchedThread, ThatTicksFirstAfterTheWholeProcessWasStoppedIsToldToo) {
    watchdog_.tick();
    clock_.advance(5s);
    watchdog_.tick();
    watchdog_.look();
    runPosted();
    EXPECT_EQ(stops_, 1);
    ASSERT_EQ(reported_.size(), 1U);
    EXPECT_EQ(reported_[0], 5s);
    EXPECT_EQ(noticed_, 1);
}

TEST_F(WatchedThread, IsToldOfEachStall) {
    for (int i = 0; i < 3; ++i) {
        watchdog_.tick();
        clock_.advance(1s);
        watchdog_.look();
        runPosted();
    }
    EXPECT_EQ(reported_.size(), 3U);
}

TEST_F(WatchedThread, IsNotWatchedAnyLongerAfterTheEnd) {
    watchdog_.tick();
    watchdog_.end();
    clock_.advance(1s);
    watchdog_.tick();
    EXPECT_EQ(stops_, 0);
    EXPECT_TRUE(reported_.empty());
}

TEST(Watchdog, LooksByItself) {
    const SystemClock clock;
    std::promise<void> stopped;
    std::promise<std::function<void()>> posted;
    std::promise<std::chrono::nanoseconds> told;
    std::atomic<bool> first = true;
    Watchdog watchdog(
        {.stop =
             [&] {
                 if (first.exchange(false)) {
                     stopped.set_value();
                 }
             },
         .post = [&](std::function<void()> work) { posted.set_value(std::move(work)); },
         .tell = [&](std::chrono::nanoseconds stalled) { told.set_value(stalled); },
         .noticed = [](std::chrono::nanoseconds) {}},
        20ms, clock);
    watchdog.tick();
    ASSERT_EQ(stopped.get_future().wait_for(60s), std::future_status::ready);
    auto work = posted.get_future();
    ASSERT_EQ(work.wait_for(60s), std::future_status::ready);
    work.get()();
    EXPECT_GT(told.get_future().get(), 20ms);
}

TEST(Watchdog, WaitsBetweenItsLooks) {
    constexpr int kLooks = 20;
    constexpr auto kShort = 80ms;
    const SystemClock clock;
    int stops = 0;
    std::promise<SteadyTime> first;
    std::promise<SteadyTime> last;
    Watchdog watchdog({.stop =
                           [&] {
                               ++stops;
                               if (stops == 1) {
                                   first.set_value(clock.now());
                               } else if (stops == kLooks) {
                                   last.set_value(clock.now());
                               }
                           },
                       .post = [](const std::function<void()>&) {},
                       .tell = [](std::chrono::nanoseconds) {},
                       .noticed = [](std::chrono::nanoseconds) {}},
                      kShort, clock);
    watchdog.tick();
    auto end = last.get_future();
    ASSERT_EQ(end.wait_for(60s), std::future_status::ready);
    EXPECT_GE(end.get() - first.get_future().get(), (kLooks - 1) * Watchdog::tickPeriod(kShort));
}

TEST(Watchdog, EndsOnlyOnceItsActionHasEnded) {
    const SystemClock clock;
    std::promise<void> begun;
    std::atomic<bool> first{true};
    std::atomic<bool> ended{false};
    Watchdog watchdog({.stop =
                           [&] {
                               if (first.exchange(false)) {
                                   begun.set_value();
                                   const auto until = clock.now() + 100ms;
                                   while (clock.now() < until) {
                                       std::this_thread::yield();
                                   }
                                   ended.store(true);
                               }
                           },
                       .post = [](const std::function<void()>&) {},
                       .tell = [](std::chrono::nanoseconds) {},
                       .noticed = [](std::chrono::nanoseconds) {}},
                      20ms, clock);
    watchdog.tick();
    ASSERT_EQ(begun.get_future().wait_for(60s), std::future_status::ready);
    watchdog.end();
    EXPECT_TRUE(ended.load());
    watchdog.end();  // again, without effect
}

TEST_F(WatchedThread, IsLookedAtAfterItsLimitIfItHasNotTickedYet) {
    EXPECT_EQ(watchdog_.look(), kLimit);
}

}  // namespace
}  // namespace metier::device
