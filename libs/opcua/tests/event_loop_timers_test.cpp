#include <gmock/gmock.h>

#include <functional>
#include <limits>
#include <string>

#include "event_loop.hpp"
#include "timers.hpp"

namespace metier::opcua {

namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;

const SteadyTime kStart{1000s};

Timer every(std::chrono::nanoseconds interval,
            UA_TimerPolicy policy = UA_TIMER_HANDLE_CYCLEMISS_WITH_CURRENTTIME) {
    return {.callback = [](void*, void*) {}, .interval = interval, .policy = policy};
}

TEST(Timers, ComeInTheOrderTheyAreDue) {
    Timers timers;
    const auto late = timers.add(every(0ns), kStart + 2ms);
    const auto early = timers.add(every(0ns), kStart + 1ms);
    EXPECT_EQ(timers.next(), kStart + 1ms);
    EXPECT_EQ(timers.takeDue(kStart + 5ms)->id, early);
    EXPECT_EQ(timers.takeDue(kStart + 5ms)->id, late);
    EXPECT_FALSE(timers.takeDue(kStart + 5ms));
}

TEST(Timers, AreNotDueTooEarly) {
    Timers timers;
    timers.add(every(0ns), kStart + 1ms);
    EXPECT_FALSE(timers.takeDue(kStart + 1ms - 1ns));
    EXPECT_TRUE(timers.takeDue(kStart + 1ms));
}

TEST(Timers, AOneShotIsGoneOnceItWasTaken) {
    Timers timers;
    timers.add(every(0ns), kStart);
    EXPECT_TRUE(timers.takeDue(kStart));
    EXPECT_EQ(timers.next(), std::nullopt);
}

TEST(Timers, ACyclicOneKeepsItsPhaseThoughItIsTakenLate) {
    Timers timers;
    timers.add(every(10ms), kStart + 10ms);
    timers.takeDue(kStart + 13ms);
    EXPECT_EQ(timers.next(), kStart + 20ms);
}

TEST(Timers, AMissedCycleCountsFromNowUnlessTheBaseTimeIsKept) {
    Timers from_now;
    from_now.add(every(10ms), kStart);
    from_now.takeDue(kStart + 34ms);
    EXPECT_EQ(from_now.next(), kStart + 44ms);

    Timers from_base;
    from_base.add(every(10ms, UA_TIMER_HANDLE_CYCLEMISS_WITH_BASETIME), kStart);
    from_base.takeDue(kStart + 34ms);
    EXPECT_EQ(from_base.next(), kStart + 40ms);
}

TEST(Timers, AChangedOneHasOnlyItsNewTime) {
    Timers timers;
    const auto id = timers.add(every(10ms), kStart);
    auto changed = every(50ms);
    changed.id = id;
    EXPECT_TRUE(timers.modify(changed, kStart + 50ms));
    EXPECT_FALSE(timers.takeDue(kStart + 49ms));
    EXPECT_EQ(timers.takeDue(kStart + 50ms)->id, id);
    EXPECT_EQ(timers.next(), kStart + 100ms);
}

TEST(Timers, ARemovedOneCanNeitherBeTakenNorChanged) {
    Timers timers;
    const auto id = timers.add(every(10ms), kStart);
    timers.remove(id);
    timers.remove(id);
    auto changed = every(10ms);
    changed.id = id;
    EXPECT_FALSE(timers.modify(changed, kStart));
    EXPECT_FALSE(timers.takeDue(kStart + 1s));
}

TEST(Timers, TheNextCycleIsAfterNowEvenIfTheBaseIsAhead) {
    EXPECT_EQ(nextCycle(kStart, kStart, 10ms), kStart + 10ms);
    EXPECT_EQ(nextCycle(kStart + 3ms, kStart, 10ms), kStart + 10ms);
    EXPECT_EQ(nextCycle(kStart, kStart + 23ms, 10ms), kStart + 3ms);
}

/// A started loop, its timers added as the stack does it.
class LoopTimers : public ::testing::Test {
protected:
    LoopTimers() { handle_->start(handle_); }

    static void call(void* /*application*/, void* work) {
        (*static_cast<std::function<void()>*>(work))();
    }
    UA_UInt64 addCyclic(double interval_ms, std::function<void()>& work) {
        UA_UInt64 id = 0;
        EXPECT_EQ(handle_->addCyclicCallback(handle_, call, nullptr, &work, interval_ms, nullptr,
                                             UA_TIMER_HANDLE_CYCLEMISS_WITH_CURRENTTIME, &id),
                  UA_STATUSCODE_GOOD);
        return id;
    }
    void addOnce(std::chrono::milliseconds in, std::function<void()>& work) {
        const auto date = handle_->dateTime_nowMonotonic(handle_) + in.count() * UA_DATETIME_MSEC;
        handle_->addTimedCallback(handle_, call, nullptr, &work, date, nullptr);
    }
    bool runUntil(const std::function<bool()>& done) {
        const auto deadline = std::chrono::steady_clock::now() + 10s;
        while (!done() && std::chrono::steady_clock::now() < deadline) {
            EXPECT_TRUE(loop_.runOnce(100ms));
        }
        return done();
    }

    AsioEventLoop loop_;
    UA_EventLoop* handle_ = loop_.handle();
};

TEST_F(LoopTimers, AOneShotFiresOnceAndNotTooEarly) {
    int fired = 0;
    std::function<void()> work = [&] { ++fired; };
    const auto start = std::chrono::steady_clock::now();
    addOnce(20ms, work);
    ASSERT_TRUE(runUntil([&] { return fired > 0; }));
    EXPECT_GE(std::chrono::steady_clock::now() - start, 19900us);  // two clocks of the machine
    EXPECT_EQ(handle_->nextCyclicTime(handle_), UA_INT64_MAX);
}

TEST_F(LoopTimers, ACallbackMayRemoveItselfAndOthersThatAreDueToo) {
    std::string calls;
    UA_UInt64 first = 0;
    UA_UInt64 second = 0;
    std::function<void()> remove_both = [&] {
        calls += "a";
        handle_->removeCyclicCallback(handle_, first);
        handle_->removeCyclicCallback(handle_, second);
    };
    std::function<void()> never = [&] { calls += "b"; };
    std::function<void()> last = [&] { calls += "c"; };
    first = addCyclic(1, remove_both);
    second = addCyclic(1.001, never);
    addOnce(10ms, last);
    ASSERT_TRUE(runUntil([&] { return calls.find('c') != std::string::npos; }));
    EXPECT_EQ(calls, "ac");
}

TEST_F(LoopTimers, ACallbackMayChangeItsOwnInterval) {
    int fired = 0;
    UA_UInt64 id = 0;
    std::function<void()> slow_down = [&] {
        ++fired;
        handle_->modifyCyclicCallback(handle_, id, 3'600'000, nullptr,
                                      UA_TIMER_HANDLE_CYCLEMISS_WITH_CURRENTTIME);
    };
    std::vector<int> at_end;
    std::function<void()> end = [&] { at_end.push_back(fired); };
    id = addCyclic(1, slow_down);
    addOnce(20ms, end);
    ASSERT_TRUE(runUntil([&] { return !at_end.empty(); }));
    EXPECT_THAT(at_end, ElementsAre(1));
}

TEST_F(LoopTimers, ManyIntervalsEachKeepTheirRate) {
    int every_2ms = 0;
    int every_10ms = 0;
    std::function<void()> count_2ms = [&] { ++every_2ms; };
    std::function<void()> count_10ms = [&] { ++every_10ms; };
    const auto start = std::chrono::steady_clock::now();
    addCyclic(2, count_2ms);
    addCyclic(10, count_10ms);
    ASSERT_TRUE(runUntil([&] { return every_10ms == 20; }));
    const auto elapsed = std::chrono::steady_clock::now() - start;
    EXPECT_GE(elapsed, 200ms);
    EXPECT_LE(every_2ms, elapsed / 2ms);
    EXPECT_GT(every_2ms, every_10ms);
}

TEST_F(LoopTimers, IntervalsThatAreNoneAreRefused) {
    for (const double interval : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
        EXPECT_EQ(handle_->addCyclicCallback(handle_, call, nullptr, nullptr, interval, nullptr,
                                             UA_TIMER_HANDLE_CYCLEMISS_WITH_CURRENTTIME, nullptr),
                  UA_STATUSCODE_BADINTERNALERROR);
    }
    EXPECT_EQ(handle_->modifyCyclicCallback(handle_, 99, 1, nullptr,
                                            UA_TIMER_HANDLE_CYCLEMISS_WITH_CURRENTTIME),
              UA_STATUSCODE_BADNOTFOUND);
}

TEST_F(LoopTimers, AnIdleLoopIteratesOnlyWhenSomethingIsDue) {
    int fired = 0;
    std::function<void()> work = [&] { ++fired; };
    addCyclic(50, work);
    const auto before = loop_.statistics().iterations;
    ASSERT_TRUE(runUntil([&] { return fired == 4; }));
    EXPECT_LE(loop_.statistics().iterations - before, 10);
}

}  // namespace

}  // namespace metier::opcua
