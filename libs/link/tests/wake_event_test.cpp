#include "metier/link/wake_event.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <future>

namespace metier::link {
namespace {

using namespace std::chrono_literals;
using std::chrono::steady_clock;

TEST(WakeEvent, IsTakenOnce) {
    WakeEvent event;
    EXPECT_FALSE(event.waitUntil(steady_clock::now()));
    event.ring();
    event.ring();
    EXPECT_TRUE(event.waitUntil(steady_clock::now()));
    EXPECT_FALSE(event.waitUntil(steady_clock::now()));
}

TEST(WakeEvent, EndsItsWaitAtTheDeadline) {
    WakeEvent event;
    const auto deadline = steady_clock::now() + 20ms;
    EXPECT_FALSE(event.waitUntil(deadline));
    EXPECT_GE(steady_clock::now(), deadline);
}

// As milliseconds these deadlines do not fit into the int that poll(2) takes.
TEST(WakeEvent, IsAwaitedAlsoWithADeadlineThatIsFarAway) {
    for (const auto deadline :
         {SteadyTime::max(), steady_clock::now() + std::chrono::milliseconds(1LL << 32)}) {
        WakeEvent event;
        auto waited = std::async(std::launch::async, [&] { return event.waitUntil(deadline); });
        EXPECT_EQ(waited.wait_for(50ms), std::future_status::timeout)
            << "it does not end by itself";
        event.ring();
        ASSERT_EQ(waited.wait_for(1min), std::future_status::ready);
        EXPECT_TRUE(waited.get());
    }
}

}  // namespace
}  // namespace metier::link
