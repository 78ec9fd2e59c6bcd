#include "metier/virtual_controller/cycle_timer.hpp"

#include <gtest/gtest.h>

#include <memory>

namespace metier::virtual_controller {
namespace {

using namespace std::chrono_literals;

TEST(CycleTimer, CallsOncePerPeriod) {
    asio::io_context context;
    int calls = 0;
    const auto begin = std::chrono::steady_clock::now();
    CycleTimer timer(context, 2ms, [&] {
        if (++calls == 50) {
            context.stop();
        }
    });
    context.run_for(10s);
    EXPECT_EQ(calls, 50);
    EXPECT_GE(std::chrono::steady_clock::now() - begin, 100ms);
}

TEST(CycleTimer, CatchesUpOnWhatALongCallDelayed) {
    asio::io_context context;
    int calls = 0;
    const auto begin = std::chrono::steady_clock::now();
    CycleTimer timer(context, 2ms, [&] {
        ++calls;
        if (calls == 1) {
            while (std::chrono::steady_clock::now() - begin < 40ms) {
            }
        }
        if (calls == 20) {
            context.stop();
        }
    });
    context.run_for(10s);
    EXPECT_EQ(calls, 20) << "the 19 calls after the long one were due already";
}

TEST(CycleTimer, TakesAnotherPeriod) {
    asio::io_context context;
    int calls = 0;
    const auto begin = std::chrono::steady_clock::now();
    CycleTimer timer(context, 1ms, [&] {
        if (++calls == 10) {
            context.stop();
        }
    });
    timer.setPeriod(20ms);
    context.run_for(10s);
    EXPECT_EQ(calls, 10);
    EXPECT_GE(std::chrono::steady_clock::now() - begin, 181ms);
}

TEST(CycleTimer, CallsNothingOnceItIsGone) {
    asio::io_context context;
    int calls = 0;
    std::unique_ptr<CycleTimer> timer;
    asio::steady_timer earlier(context, SteadyTime{});  // due with it, and in front of it
    earlier.async_wait([&](const asio::error_code&) { timer.reset(); });
    timer = std::make_unique<CycleTimer>(context, 1ns, [&] { ++calls; });
    context.run_for(10s);
    EXPECT_FALSE(timer);
    EXPECT_EQ(calls, 0);
}

}  // namespace
}  // namespace metier::virtual_controller
