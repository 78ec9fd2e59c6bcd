#include "metier/path_evaluation/placement.hpp"

#include <gmock/gmock.h>

#include <filesystem>

#include "metier/motion/kinematics.hpp"
#include "metier/motion/robot_model.hpp"

namespace metier::path_evaluation {
namespace {

using ::testing::HasSubstr;

motion::ChainDescription chainOf(const std::string& robot) {
    const auto file = std::filesystem::path(METIER_MODELS) / (robot + ".toml");
    return motion::RobotModel::load(file).value().chain();
}

class PlaceSquare : public ::testing::TestWithParam<const char*> {};

TEST_P(PlaceSquare, FindsASquareThatTheArmFollowsWithoutChangingItsBranch) {
    const auto chain = chainOf(GetParam());
    const motion::Kinematics arm(chain);
    const auto square = placeSquare(chain, chain.home, 0.1);
    ASSERT_TRUE(square) << square.error().message;
    auto joints = arm.inverse(square->start, {chain.home, {}, std::nullopt}).value();
    for (std::size_t corner = 1; corner <= kCorners; ++corner) {
        const auto next = arm.inverse(square->corner(corner), {joints, {}, std::nullopt});
        ASSERT_TRUE(next) << next.error().message;
        EXPECT_LT(motion::maxDifference(*next, joints), 1.0);
        joints = *next;
    }
}

TEST_P(PlaceSquare, StandsUprightAndKeepsAwayFromSingularities) {
    const auto chain = chainOf(GetParam());
    const motion::Kinematics arm(chain);
    const auto square = placeSquare(chain, chain.home, 0.1).value();
    EXPECT_NEAR(square.right.z(), 0.0, 1e-12);
    EXPECT_TRUE(square.up.isApprox(Eigen::Vector3d::UnitZ()));
    const auto start = arm.inverse(square.start, {chain.home, {}, std::nullopt}).value();
    EXPECT_GT(arm.smallestSingularValue(start), 0.05);
}

INSTANTIATE_TEST_SUITE_P(Arms, PlaceSquare,
                         ::testing::Values("ur5", "ur5e", "iiwa7", "iiwa14", "edo"),
                         [](const auto& arm) { return std::string(arm.param); });

TEST(PlaceSquareTooLarge, IsRefusedWithTheReach) {
    const auto chain = chainOf("edo");
    const auto square = placeSquare(chain, chain.home, 3.0);
    ASSERT_FALSE(square);
    EXPECT_EQ(square.error().code, Errc::unreachable);
    EXPECT_THAT(square.error().message, HasSubstr("reach"));
}

TEST(PlaceSquareTooLarge, RefusesASideOfNothing) {
    const auto chain = chainOf("edo");
    EXPECT_EQ(placeSquare(chain, chain.home, 0.0).error().code, Errc::invalid_argument);
}

}  // namespace
}  // namespace metier::path_evaluation
