#include "metier/path_evaluation/placement.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>

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

TEST(PlaceSquareTooLarge, RefusesWhatIsNoLengthOrNoPositionOfTheArm) {
    const auto chain = chainOf("edo");
    const double infinity = std::numeric_limits<double>::infinity();
    EXPECT_EQ(placeSquare(chain, chain.home, -0.1).error().code, Errc::invalid_argument);
    EXPECT_EQ(placeSquare(chain, chain.home, std::nan("")).error().code, Errc::invalid_argument);
    EXPECT_EQ(placeSquare(chain, chain.home, infinity).error().code, Errc::unreachable);
    auto position = chain.home;
    position[2] = infinity;
    EXPECT_EQ(placeSquare(chain, position, 0.1).error().code, Errc::invalid_argument);
    const auto shorter = placeSquare(chain, motion::JointVector(5), 0.1);
    ASSERT_FALSE(shorter);
    EXPECT_EQ(shorter.error().message,
              "a square of 0.1 m for an arm of 6 axes at 5 joint positions");
}

TEST(PlaceSquareSide, IsWhereTheArmPointsTo) {
    const auto chain = chainOf("ur5");
    const motion::Kinematics arm(chain);
    for (const double turn : {-2.0, 0.0, 1.5}) {
        auto position = chain.home;
        position[0] += turn;
        const auto square = placeSquare(chain, position, 0.1).value();
        const auto tool = arm.forward(position).translation;
        const Eigen::Vector3d middle =
            0.5 * (square.corner(0).translation + square.corner(2).translation);
        const double between =
            std::remainder(std::atan2(middle.y(), middle.x()) - std::atan2(tool.y(), tool.x()),
                           2 * std::numbers::pi);
        EXPECT_LE(std::abs(between), 0.5 + 1e-9) << turn;
    }
}

}  // namespace
}  // namespace metier::path_evaluation
