#include "metier/motion/joint_vector.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <vector>

namespace metier::motion {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(JointVector, HoldsSevenAxesAndNoMore) {
    EXPECT_EQ(JointVector::from(std::vector<double>(7, 1.0))->size(), 7U);
    const auto refused = JointVector::from(std::vector<double>(8, 1.0));
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr("8 axes, at most 7"));
    EXPECT_EQ(JointVector({1, 2, 3, 4, 5, 6, 7, 8}), JointVector({1, 2, 3, 4, 5, 6, 7}));
    EXPECT_TRUE(JointVector::from({})->empty());
}

TEST(JointVector, IsMadeOfFiniteValuesOnly) {
    for (const double wrong : {std::nan(""), std::numeric_limits<double>::infinity()}) {
        EXPECT_EQ(JointVector::from(std::vector{0.0, wrong}).error().code, Errc::invalid_argument);
        EXPECT_FALSE(JointVector({0.0, wrong}).allFinite());
    }
    EXPECT_THAT(JointVector::from(std::vector{1.5, -2.5})->span(), ElementsAre(1.5, -2.5));
}

TEST(JointVector, IsEqualToOneOfTheSameSizeAndValues) {
    EXPECT_EQ(JointVector({1, 2}), JointVector({1, 2}));
    EXPECT_NE(JointVector({1, 2}), JointVector({1, 2, 0})) << "another arm";
    EXPECT_NE(JointVector({1, 2}), JointVector({1, 3}));
    EXPECT_TRUE(JointVector(3).allZero());
    EXPECT_TRUE(JointVector().allZero());
    EXPECT_FALSE(JointVector({0, -1e-300}).allZero());
}

TEST(JointVector, DiffersByTheLargestDifferenceOfAnAxis) {
    EXPECT_EQ(maxDifference({1, 2, 3}, {1, 5, 2}), 3.0);
    EXPECT_EQ(maxDifference({1, 2, 3}, {2, 2, -1}), 4.0);
    EXPECT_EQ(maxDifference({}, {}), 0.0);
}

}  // namespace
}  // namespace metier::motion
