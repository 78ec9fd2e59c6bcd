// Paths and poses: invariants over random inputs.
#include "segment.hpp"

#include <gtest/gtest.h>

#include <random>

#include "movement.hpp"

namespace metier::virtual_edo {
namespace {

constexpr int kRounds = 200;

TEST(Segment, PassesItsPositionsAndIsExactAtItsEnds) {
    std::vector<AxisValues> path(4);
    for (std::size_t i = 0; i < path.size(); ++i) {
        path[i].fill(static_cast<double>(i * i) + 0.1);
    }
    const Segment segment(path, virtual_controller::Trapezoid(1.0, 1e3, 4.0));
    EXPECT_EQ(segment.at(-1.0), path.front());
    EXPECT_EQ(segment.at(segment.duration()), path.back());
    EXPECT_EQ(segment.at(1e9), path.back());
    // A triangle of 1 s: half of the way at half of the time, between the positions 1 and 4.
    EXPECT_NEAR(segment.at(0.5)[3], 0.1 + (1.0 + 4.0) / 2.0, 1e-9);
    EXPECT_EQ(segment.start(), path.front());
    EXPECT_EQ(segment.end(), path.back());
}

TEST(CartesianPose, IsThePoseItWasMadeFrom) {
    std::mt19937 random(5);  // NOLINT: the same poses at each run
    std::uniform_real_distribution<> number(-1.0, 1.0);
    for (int round = 0; round < kRounds; ++round) {
        const motion::Pose pose{.translation = {number(random), number(random), number(random)},
                                .rotation = Eigen::Quaterniond(number(random), number(random),
                                                               number(random), number(random))
                                                .normalized()};
        const auto wire = toCartesian(pose);
        EXPECT_GE(wire.e, 0.0);
        EXPECT_LE(wire.e, 180.0);
        const auto back = toPose(wire);
        EXPECT_TRUE(back.translation.isApprox(pose.translation, 1e-12));
        EXPECT_NEAR(back.rotation.angularDistance(pose.rotation), 0.0, 1e-6);
    }
}

TEST(CartesianPose, HasOneTurnWhereOnlyTheSumOfTwoIsDefined) {
    const auto upright = toCartesian(toPose({.x = 1, .a = 30, .e = 0, .r = 25}));
    EXPECT_EQ(upright.a, 0.0);
    EXPECT_NEAR(upright.r, 55.0, 1e-9);
    const auto turned = toCartesian(toPose({.a = 30, .e = 180, .r = 25}));
    EXPECT_EQ(turned.a, 0.0);
    EXPECT_NEAR(turned.e, 180.0, 1e-9);
    const auto again = toPose(turned);
    EXPECT_NEAR(again.rotation.angularDistance(toPose({.a = 30, .e = 180, .r = 25}).rotation), 0.0,
                1e-6);
}

}  // namespace
}  // namespace metier::virtual_edo
