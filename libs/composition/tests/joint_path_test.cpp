#include "synchronized/joint_path.hpp"

#include <gmock/gmock.h>

namespace metier::composition {
namespace {

using ::testing::HasSubstr;

const JointPath kPath{{0.0, 0.0}, {1.0, 2.0}, {2.0, 4.0}};

TEST(OffPath, IsEmptyOnTheLinesBetweenItsPlaces) {
    EXPECT_EQ(offPath(kPath, {0.0, 0.0}), "");
    EXPECT_EQ(offPath(kPath, {0.25, 0.5}), "");
    EXPECT_EQ(offPath(kPath, {1.75, 3.501}), "");
    EXPECT_EQ(offPath(kPath, {2.0, 4.0}), "");
}

TEST(OffPath, TellsTheAxisThatIsFurthestOffBesideIt) {
    EXPECT_THAT(offPath(kPath, {1.1, 2.0}), HasSubstr("axis 1 by 0.08"));
}

TEST(OffPath, TellsWhoIsBeforeOrBehindIt) {
    EXPECT_EQ(offPath(kPath, {0.0, -0.01}), "axis 2 by 0.0100 rad, limit 0.002 rad");
    EXPECT_EQ(offPath(kPath, {2.05, 4.0}), "axis 1 by 0.0500 rad, limit 0.002 rad");
}

TEST(BrakingTime, IsFromTheLastOfTheLargestStepsToTheEnd) {
    const JointPath path{{0.0}, {0.1}, {0.4}, {0.7}, {1.0}, {1.2}, {1.3}};
    EXPECT_NEAR(brakingTime(path, 1.2), 0.6, 1e-9) << "the last three of six";
    EXPECT_NEAR(brakingTime(kPath, 1.0), 0.5, 1e-9);
}

TEST(BrakingTime, IsNoneWithoutAWay) {
    EXPECT_EQ(brakingTime({{0.3}}, 0.0), 0.0);
    EXPECT_EQ(brakingTime({{0.3}, {0.3}}, 0.0), 0.0);
}

TEST(OffPath, OfOtherAxesIsOff) {
    EXPECT_EQ(offPath(kPath, {0.0}), "1 axes instead of 2");
}

}  // namespace
}  // namespace metier::composition
