#include "metier/base/recent_mean.hpp"

#include <gtest/gtest.h>

namespace metier {
namespace {

using namespace std::chrono_literals;

struct RecentMeanTest : ::testing::Test {
    ManualClock clock;
    TimeHistogram times;
    RecentMean mean{times, clock, 100ms};
};

TEST_F(RecentMeanTest, IsOfWhatWasAddedInTheLastSpanAlone) {
    times.add(0.001);
    times.add(0.003);
    EXPECT_FALSE(mean.read()) << "its span has not passed";
    clock.advance(100ms);
    EXPECT_DOUBLE_EQ(mean.read().value(), 0.002);
    times.add(0.5);
    clock.advance(99ms);
    EXPECT_DOUBLE_EQ(mean.read().value(), 0.002) << "as it was, until the next span has passed";
    clock.advance(1ms);
    EXPECT_DOUBLE_EQ(mean.read().value(), 0.5);
}

TEST_F(RecentMeanTest, IsNothingOnceNothingIsAdded) {
    times.add(0.001);
    clock.advance(1s);
    EXPECT_TRUE(mean.read());
    clock.advance(1s);
    EXPECT_FALSE(mean.read());
}

TEST(RecentMean, IsNotOfWhatWasAddedBefore) {
    ManualClock clock;
    TimeHistogram times;
    times.add(100.0);
    RecentMean mean(times, clock, 100ms);
    times.add(0.001);
    clock.advance(100ms);
    EXPECT_NEAR(mean.read().value(), 0.001, 1e-9);
}

}  // namespace
}  // namespace metier
