#include "metier/base/clock.hpp"

#include <gtest/gtest.h>

namespace metier {
namespace {

using namespace std::chrono_literals;

TEST(ManualClock, StandsUntilItIsMoved) {
    ManualClock clock;
    const auto start = clock.now();
    const auto utc_start = clock.utcNow();
    EXPECT_EQ(clock.now(), start);
    clock.advance(20ms);
    EXPECT_EQ(clock.now() - start, 20ms);
    EXPECT_EQ(clock.utcNow() - utc_start, 20ms);
}

}  // namespace
}  // namespace metier
