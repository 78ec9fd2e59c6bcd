#include "metier/joint_simulator/time_base.hpp"

#include <gtest/gtest.h>

namespace metier::joint_simulator {
namespace {

using namespace std::chrono_literals;

constexpr SteadyTime kStart{};

TEST(TimeBase, IsDueOncePerPeriod) {
    TimeBase time_base(kStart, 8ms);
    EXPECT_EQ(time_base.begin(kStart), kStart);
    EXPECT_EQ(time_base.next(), kStart + 8ms);
    EXPECT_EQ(time_base.begin(kStart + 15ms), kStart + 8ms);
    EXPECT_EQ(time_base.missed(), 0U);
}

TEST(TimeBase, CatchesUpCycleByCycleAfterADelay) {
    TimeBase time_base(kStart, 8ms);
    EXPECT_EQ(time_base.begin(kStart + 30ms), kStart);
    EXPECT_EQ(time_base.begin(kStart + 30ms), kStart + 8ms);
    EXPECT_EQ(time_base.begin(kStart + 30ms), kStart + 16ms);
    EXPECT_EQ(time_base.begin(kStart + 30ms), kStart + 24ms);
    EXPECT_EQ(time_base.next(), kStart + 32ms);
    EXPECT_EQ(time_base.missed(), 3U) << "the last of them is less than one period late";
}

TEST(TimeBase, MovesToThePresentAfterALongDelay) {
    TimeBase time_base(kStart, 8ms);
    EXPECT_EQ(time_base.begin(kStart + 801ms), kStart + 800ms);
    EXPECT_EQ(time_base.next(), kStart + 808ms);
    EXPECT_EQ(time_base.missed(), 100U);
}

}  // namespace
}  // namespace metier::joint_simulator
