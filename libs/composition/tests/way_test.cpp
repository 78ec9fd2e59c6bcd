#include "synchronized/way.hpp"

#include <gmock/gmock.h>

namespace metier::composition {
namespace {

using ::testing::HasSubstr;

const Way kWay{{0.0, 0.0}, {1.0, 2.0}, {2.0, 4.0}};

TEST(OffWay, IsEmptyOnTheLinesBetweenItsPlaces) {
    EXPECT_EQ(offWay(kWay, {0.0, 0.0}), "");
    EXPECT_EQ(offWay(kWay, {0.25, 0.5}), "");
    EXPECT_EQ(offWay(kWay, {1.75, 3.501}), "");
    EXPECT_EQ(offWay(kWay, {2.0, 4.0}), "");
}

TEST(OffWay, TellsTheAxisThatIsFurthestOffBesideIt) {
    EXPECT_THAT(offWay(kWay, {1.1, 2.0}), HasSubstr("axis 1 by 0.08"));
}

TEST(OffWay, TellsWhoIsBeforeOrBehindIt) {
    EXPECT_EQ(offWay(kWay, {0.0, -0.01}), "axis 2 by 0.0100 rad, limit 0.002 rad");
    EXPECT_EQ(offWay(kWay, {2.05, 4.0}), "axis 1 by 0.0500 rad, limit 0.002 rad");
}

TEST(BrakingTime, IsFromTheLastOfTheLargestStepsToTheEnd) {
    const Way way{{0.0}, {0.1}, {0.4}, {0.7}, {1.0}, {1.2}, {1.3}};
    EXPECT_NEAR(brakingTime(way, 1.2), 0.6, 1e-9) << "the last three of six";
    EXPECT_NEAR(brakingTime(kWay, 1.0), 0.5, 1e-9);
}

TEST(BrakingTime, IsNoneWithoutAWay) {
    EXPECT_EQ(brakingTime({{0.3}}, 0.0), 0.0);
    EXPECT_EQ(brakingTime({{0.3}, {0.3}}, 0.0), 0.0);
}

TEST(OffWay, OfOtherAxesIsOff) {
    EXPECT_EQ(offWay(kWay, {0.0}), "1 axes instead of 2");
}

}  // namespace
}  // namespace metier::composition
