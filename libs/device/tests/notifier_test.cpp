#include "metier/device/notifier.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <future>
#include <thread>

namespace metier::device {
namespace {

using namespace std::chrono_literals;

TEST(Notifier, CallsItsHandlerOnItsOwnThread) {
    std::promise<std::thread::id> called;
    Notifier notifier([&] { called.set_value(std::this_thread::get_id()); });
    notifier.signal();
    auto id = called.get_future();
    ASSERT_EQ(id.wait_for(10s), std::future_status::ready);
    EXPECT_NE(id.get(), std::this_thread::get_id());
}

TEST(Notifier, HandlesTheLastSignalBeforeItEnds) {
    std::atomic<int> calls = 0;
    {
        Notifier notifier([&] { ++calls; });
        notifier.signal();
    }
    EXPECT_EQ(calls, 1);
}

TEST(Notifier, NeverMissesTheLastOfManySignals) {
    std::atomic<int> sent = 0;
    std::atomic<int> seen = 0;
    {
        Notifier notifier([&] { seen = sent.load(); });
        for (int i = 0; i < 10'000; ++i) {
            ++sent;
            notifier.signal();
        }
    }
    EXPECT_EQ(seen, 10'000);
}

TEST(Notifier, StaysSilentWithoutASignal) {
    std::atomic<int> calls = 0;
    {
        const Notifier notifier([&] { ++calls; });
    }
    EXPECT_EQ(calls, 0);
}

}  // namespace
}  // namespace metier::device
