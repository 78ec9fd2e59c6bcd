#include "metier/link/back_off.hpp"

#include <gtest/gtest.h>

namespace metier::link {
namespace {

TEST(BackOff, GrowsToItsLongestPauseAndBeginsAnewAfterASuccess) {
    std::stop_source stop;
    stop.request_stop();  // so that nothing waits
    BackOff back_off;
    EXPECT_EQ(back_off.next(), BackOff::kShortest);
    back_off.wait(stop.get_token());
    EXPECT_EQ(back_off.next(), 2 * BackOff::kShortest);
    for (int i = 0; i < 10; ++i) {
        back_off.wait(stop.get_token());
    }
    EXPECT_EQ(back_off.next(), BackOff::kLongest);
    back_off.reset();
    EXPECT_EQ(back_off.next(), BackOff::kShortest);
}

TEST(BackOff, WaitsForItsPause) {
    BackOff back_off;
    const auto begin = std::chrono::steady_clock::now();
    back_off.wait(std::stop_token());
    EXPECT_GE(std::chrono::steady_clock::now() - begin, BackOff::kShortest);
}

}  // namespace
}  // namespace metier::link
