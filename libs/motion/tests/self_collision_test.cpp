#include "self_collision.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <random>

#include "metier/motion/planner.hpp"
#include "test_robots.hpp"

namespace metier::motion {
namespace {

using testing::HasSubstr;

/// Distance by trying many points of both segments.
double triedDistance(const std::array<Eigen::Vector3d, 4>& p) {
    double least = 1e9;
    constexpr int kSteps = 200;
    for (int i = 0; i <= kSteps; ++i) {
        const Eigen::Vector3d a = p[0] + (p[1] - p[0]) * i / kSteps;
        const Eigen::Vector3d b = p[3] - p[2];
        const double u = std::clamp((a - p[2]).dot(b) / b.squaredNorm(), 0.0, 1.0);
        least = std::min(least, (a - p[2] - u * b).norm());
    }
    return least;
}

TEST(SegmentDistance, IsTheLeastOfAllPoints) {
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> unit(-1, 1);
    for (int i = 0; i < 500; ++i) {
        std::array<Eigen::Vector3d, 4> p;
        for (Eigen::Vector3d& point : p) {
            point = {unit(random), unit(random), unit(random)};
        }
        EXPECT_NEAR(segmentDistance(p[0], p[1], p[2], p[3]), triedDistance(p), 1e-2);
        EXPECT_LE(segmentDistance(p[0], p[1], p[2], p[3]), triedDistance(p) + 1e-12);
    }
}

TEST(SegmentDistance, KnowsParallelSegmentsAndPoints) {
    const Eigen::Vector3d o(0, 0, 0);
    const Eigen::Vector3d x(1, 0, 0);
    const Eigen::Vector3d y(0, 1, 0);
    EXPECT_NEAR(segmentDistance(o, x, y, y + x), 1.0, 1e-15);
    EXPECT_NEAR(segmentDistance(o, x, y + 3 * x, y + 4 * x), std::sqrt(5.0), 1e-15);
    EXPECT_NEAR(segmentDistance(o, o, y, y), 1.0, 1e-15);
}

using SelfCollisionOf = EachRobot;
INSTANTIATE_TEST_SUITE_P(Robots, SelfCollisionOf, testing::ValuesIn(kRobots), robotName);

TEST_P(SelfCollisionOf, IsFarAwayAtHome) {
    const SelfCollision collision(model_);
    EXPECT_GE(collision.pairCount(), 10U);
    const auto nearest = collision.nearest(model_.home());
    ASSERT_TRUE(nearest);
    EXPECT_GT(nearest->distance, 0.03);
}

TEST(SelfCollision, RefusesAMoveThatFoldsTheWristIntoTheBaseAndNamesBothLinks) {
    const RobotModel model = loadRobot("ur5");
    PtpRequest request;
    request.start = model.home();
    request.target = JointVector{0, -2.2, 2.9, -0.5, -1.57, 0};
    const auto plan = Planner(model).ptp(request);
    ASSERT_FALSE(plan);
    EXPECT_EQ(plan.error().reason, RefusalReason::collision);
    EXPECT_THAT(plan.error().error.message, HasSubstr("wrist"));
    EXPECT_THAT(plan.error().error.message, HasSubstr("would touch"));
    EXPECT_GT(plan.error().fraction, 0.0);
}

std::string ur5WithoutPairs(const std::string& pairs) {
    std::ifstream file(std::string(METIER_MODELS_DIR) + "/ur5.toml");
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    return "not_compared = " + pairs + "\n" + text;
}

TEST(SelfCollision, DoesNotCompareThePairsThatTheModelNames) {
    const SelfCollision all(loadRobot("ur5"));
    const JointVector folded{0, -2.2, 2.9, -0.5, -1.57, 0};
    const auto deepest = all.nearest(folded);
    ASSERT_TRUE(deepest);
    const auto [low, high] = std::minmax(deepest->first, deepest->second);
    const auto pairs = fmt::format("[[{}, {}], [1, 2], [{}, {}]]", high, low, low, high);
    const auto model = RobotModel::parse(ur5WithoutPairs(pairs), "ur5.toml");
    ASSERT_TRUE(model) << model.error().message;
    const SelfCollision others(*model);
    EXPECT_EQ(others.pairCount(), all.pairCount() - 1);
    EXPECT_GT(others.nearest(folded)->distance, deepest->distance);
}

TEST(SelfCollision, RefusesPairsThatAreNone) {
    for (const char* wrong : {"[[0, 7]]", "[[0]]", "[[1, 1]]", "[[0, 1, 2]]", "[[0, -1]]",
                              "[[0, 1.5]]", "[3]", "3", "[[0, \"a\"]]"}) {
        const auto model = RobotModel::parse(ur5WithoutPairs(wrong), "ur5.toml");
        ASSERT_FALSE(model) << wrong;
        EXPECT_THAT(model.error().message, HasSubstr("ur5.toml:1: not_compared")) << wrong;
    }
}

TEST(SelfCollision, HasNothingToCompareWithoutCapsules) {
    const RobotModel model = RobotModel::fromChain(loadRobot("ur5").chain()).value();
    EXPECT_FALSE(SelfCollision(model).nearest(model.home()));
}

}  // namespace
}  // namespace metier::motion
