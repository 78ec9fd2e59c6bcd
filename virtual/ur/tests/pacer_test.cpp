#include "pacer.hpp"

#include <gmock/gmock.h>

#include <memory>
#include <vector>

namespace metier::virtual_ur {
namespace {

using namespace std::chrono_literals;
using Time = std::chrono::steady_clock::time_point;

TEST(Pacer, CatchesUpEvenly) {
    asio::io_context context;
    std::vector<Time> calls;
    const auto begin = std::chrono::steady_clock::now();
    const Pacer pacer(context, 8ms, [&] {
        calls.push_back(std::chrono::steady_clock::now());
        if (calls.size() == 2) {  // the machine has no time for us
            while (std::chrono::steady_clock::now() < calls.back() + 40ms) {
            }
        }
        if (calls.size() == 12) {
            context.stop();
        }
    });
    context.run();
    for (std::size_t i = 1; i < calls.size(); ++i) {
        EXPECT_GE(calls[i] - calls[i - 1], 2ms) << i;
    }
    // On its grid again, or later on a machine that is busier still.
    EXPECT_GE(calls.back() - begin, 12 * 8ms);
}

TEST(Pacer, LeavesOutWhatIsTooLongAgo) {
    asio::io_context context;
    int calls = 0;
    Time late_until;
    const Pacer pacer(context, 2ms, [&] {
        if (++calls == 1) {
            late_until = std::chrono::steady_clock::now() + 150ms;
            while (std::chrono::steady_clock::now() < late_until) {
            }
        }
        if (calls == 21) {
            context.stop();
        }
    });
    context.run();
    // Caught up, they would take a quarter of that.
    EXPECT_GE(std::chrono::steady_clock::now() - late_until, 19 * 2ms);
}

TEST(Pacer, CallsNothingOnceItIsGone) {
    asio::io_context context;
    int calls = 0;
    std::unique_ptr<Pacer> pacer;
    asio::steady_timer earlier(context, Time{});  // due with it, and in front of it
    earlier.async_wait([&](const asio::error_code&) { pacer.reset(); });
    pacer = std::make_unique<Pacer>(context, 1ns, [&] { ++calls; });
    context.run_for(10s);
    EXPECT_FALSE(pacer);
    EXPECT_EQ(calls, 0);
}

}  // namespace
}  // namespace metier::virtual_ur
