#include "metier/path_evaluation/square.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace metier::path_evaluation {
namespace {

Square unitSquare() {
    Square square;
    square.start.translation = {0.5, 0.1, 0.3};
    return square;  // right is y, up is z, 0.1 m
}

TEST(Square, StandsUprightAndClosesAtItsStart) {
    const auto square = unitSquare();
    EXPECT_TRUE(square.corner(1).translation.isApprox(Eigen::Vector3d(0.5, 0.2, 0.3)));
    EXPECT_TRUE(square.corner(2).translation.isApprox(Eigen::Vector3d(0.5, 0.2, 0.4)));
    EXPECT_TRUE(square.corner(3).translation.isApprox(Eigen::Vector3d(0.5, 0.1, 0.4)));
    EXPECT_TRUE(square.corner(4).translation.isApprox(square.corner(0).translation));
}

TEST(Square, KeepsTheOrientationOfItsStart) {
    auto square = unitSquare();
    square.start.rotation = Eigen::AngleAxisd(1.0, Eigen::Vector3d::UnitX());
    for (std::size_t i = 0; i < kCorners; ++i) {
        EXPECT_TRUE(square.corner(i).rotation.isApprox(square.start.rotation));
    }
}

TEST(DistanceFromSegment, IsMeasuredToTheNearestPointOfTheLine) {
    const Eigen::Vector3d from(0, 0, 0);
    const Eigen::Vector3d to(1, 0, 0);
    EXPECT_DOUBLE_EQ(distanceFromSegment({0.5, 0.2, 0}, from, to), 0.2);
    EXPECT_DOUBLE_EQ(distanceFromSegment({2, 0, 0}, from, to), 1.0);
    EXPECT_DOUBLE_EQ(distanceFromSegment({0, 3, 4}, from, from), 5.0);
}

TEST(Measure, FindsTheLargestDeviationAndTheGapAtTheEnd) {
    const auto square = unitSquare();
    const std::vector<Eigen::Vector3d> positions{
        {0.5, 0.1, 0.3}, {0.502, 0.15, 0.3}, {0.5, 0.2, 0.35}, {0.5, 0.1, 0.301}};
    const auto measured = measure(square, positions);
    EXPECT_NEAR(measured.largest_deviation, 0.002, 1e-12);
    EXPECT_NEAR(measured.closure_error, 0.001, 1e-12);
}

TEST(Measure, SeesACornerThatWasCut) {
    const auto square = unitSquare();
    const std::vector<Eigen::Vector3d> positions{{0.5, 0.19, 0.31}};
    EXPECT_NEAR(measure(square, positions).largest_deviation, 0.01, 1e-12);
}

TEST(Measure, OfNothingIsZero) {
    EXPECT_DOUBLE_EQ(measure(unitSquare(), {}).largest_deviation, 0.0);
}

/// A square on the side of the arm that points by `azimuth` from x.
Square squareAt(double azimuth) {
    auto square = unitSquare();
    square.right = {-std::sin(azimuth), std::cos(azimuth), 0};
    square.side = 0.2;
    return square;
}

TEST(DistanceFromOutline, IsZeroOnEverySideWhateverTheSquaresDirection) {
    for (const double azimuth : {0.0, 0.7, -2.5, 3.1}) {
        const auto square = squareAt(azimuth);
        for (std::size_t i = 0; i < kCorners; ++i) {
            const Eigen::Vector3d from = square.corner(i).translation;
            const Eigen::Vector3d to = square.corner(i + 1).translation;
            EXPECT_NEAR((to - from).norm(), square.side, 1e-12);
            EXPECT_NEAR(distanceFromOutline(square, from + 0.3 * (to - from)), 0.0, 1e-12);
        }
    }
}

TEST(DistanceFromOutline, IsLargestInTheMiddleAndCountsOffThePlane) {
    const auto square = squareAt(0.7);
    const Eigen::Vector3d middle =
        0.5 * (square.corner(0).translation + square.corner(2).translation);
    const Eigen::Vector3d normal = square.right.cross(square.up);
    EXPECT_NEAR(distanceFromOutline(square, middle), 0.1, 1e-12);
    EXPECT_NEAR(distanceFromOutline(square, middle + 0.1 * normal), std::hypot(0.1, 0.1), 1e-12);
    EXPECT_NEAR(distanceFromOutline(
                    square, square.corner(1).translation + 0.03 * square.right + 0.04 * normal),
                0.05, 1e-12);
}

TEST(Measure, APathThatIsShiftedHasItsShiftAsDeviationAndStillCloses) {
    const auto square = squareAt(-2.5);
    const Eigen::Vector3d shift = 0.003 * square.right.cross(square.up);
    std::vector<Eigen::Vector3d> positions;
    for (std::size_t i = 0; i <= kCorners; ++i) {
        positions.push_back(square.corner(i).translation + shift);
    }
    const auto measured = measure(square, positions);
    EXPECT_NEAR(measured.largest_deviation, 0.003, 1e-12);
    EXPECT_NEAR(measured.closure_error, 0.0, 1e-12);
}

TEST(Measure, APositionThatIsNoNumberIsNotOverlooked) {
    const auto square = unitSquare();
    const std::vector<Eigen::Vector3d> positions{
        {0.5, 0.1, 0.3}, {std::nan(""), 0.15, 0.3}, {0.5, 0.1, 0.3}};
    EXPECT_FALSE(measure(square, positions).largest_deviation < 1.0);
}

}  // namespace
}  // namespace metier::path_evaluation
