#include "metier/device/joint_array.hpp"

#include <gtest/gtest.h>

#include <type_traits>
#include <vector>

namespace metier::device {
namespace {

static_assert(std::is_trivially_copyable_v<JointArray>);

TEST(JointArray, CopiesTheValuesItIsGiven) {
    const std::vector<double> values{0.1, -0.2, 0.3};
    const JointArray joints{std::span<const double>(values)};
    ASSERT_EQ(joints.size(), 3U);
    EXPECT_EQ(joints[1], -0.2);
    EXPECT_EQ(std::vector<double>(joints.begin(), joints.end()), values);
}

TEST(JointArray, DiffersByItsSizeToo) {
    EXPECT_EQ(JointArray(3), JointArray(3));
    EXPECT_FALSE(JointArray(3) == JointArray(4));
}

TEST(JointArray, GivesTheLargestDifferenceOfAnAxis) {
    JointArray a(2);
    JointArray b(2);
    a[0] = 0.5;
    b[1] = 0.75;
    EXPECT_EQ(largestDifference(a, b), 0.75);
    EXPECT_EQ(largestDifference(a, a), 0.0);
}

}  // namespace
}  // namespace metier::device
