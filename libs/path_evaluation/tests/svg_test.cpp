#include "svg.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <pugixml.hpp>

namespace metier::path_evaluation {
namespace {

using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::SizeIs;

TEST(Svg, KeepsOfAStraightLineItsEnds) {
    std::vector<Spot> spots;
    for (int i = 0; i <= 100; ++i) {
        spots.push_back({1.0 * i, 2.0 * i});
    }
    EXPECT_THAT(simplified(spots, 0.1), SizeIs(2));
}

TEST(Svg, ASimplifiedCurveStaysWithinItsTolerance) {
    std::vector<Spot> spots;
    for (int i = 0; i <= 1000; ++i) {
        spots.push_back({0.5 * i, 50 * std::sin(0.02 * i)});
    }
    const auto kept = simplified(spots, 0.1);
    EXPECT_THAT(kept, SizeIs(::testing::Lt(200)));
    for (const auto& spot : spots) {
        const auto right = std::find_if(kept.begin() + 1, kept.end() - 1,
                                        [&](const Spot& other) { return other.x >= spot.x; });
        const auto left = right - 1;
        const double share = (spot.x - left->x) / (right->x - left->x);
        EXPECT_NEAR(spot.y, left->y + share * (right->y - left->y), 0.3) << spot.x;
    }
}

TEST(Svg, KeepsASpotThatALineReturnsFrom) {
    const std::vector<Spot> spots{{0, 0}, {10, 0}, {0, 0}};
    EXPECT_THAT(simplified(spots, 0.1), SizeIs(3));
}

TEST(Svg, TicksAreRoundAndInside) {
    EXPECT_THAT(ticksBetween(-0.31, 0.52, 4),
                ElementsAre(DoubleNear(0, 0), DoubleNear(0.5, 1e-12)));
    EXPECT_THAT(ticksBetween(0, 1.1, 4), ElementsAre(0, 0.5, 1));
    EXPECT_THAT(ticksBetween(0.0, 7.9, 8), SizeIs(8));
}

TEST(Svg, EscapesTextsAndClosesWhatItOpens) {
    SvgPicture picture(10, 10, "");
    picture.beginClip({0, 0, 5, 5});
    picture.text({1, 1}, "note", "a < b & \"c\" > d");
    picture.endClip();
    const auto svg = std::move(picture).finish();
    pugi::xml_document document;
    ASSERT_TRUE(document.load_string(svg.c_str())) << svg;
    EXPECT_STREQ(document.select_node("//text").node().text().get(), "a < b & \"c\" > d");
}

TEST(Svg, RoundedUpIsTheNextOfOneTwoAndFive) {
    EXPECT_NEAR(roundedUp(0.3), 0.5, 1e-12);
    EXPECT_NEAR(roundedUp(0.5), 0.5, 1e-12);
    EXPECT_NEAR(roundedUp(0.51), 1.0, 1e-12);
    EXPECT_NEAR(roundedUp(17), 20, 1e-9);
    EXPECT_NEAR(roundedUp(1000), 1000, 1e-9);
    EXPECT_NEAR(roundedUp(0), 1e-6, 1e-18);
    EXPECT_NEAR(roundedUp(-3), 1e-6, 1e-18);
}

TEST(Svg, TicksFarFromZeroAreFewAndInside) {
    const auto ticks = ticksBetween(1234.5, 1234.9, 4);
    EXPECT_THAT(ticks, SizeIs(::testing::AllOf(::testing::Ge(2), ::testing::Le(5))));
    for (const double tick : ticks) {
        EXPECT_GE(tick, 1234.5 - 1e-6);
        EXPECT_LE(tick, 1234.9 + 1e-6);
    }
    EXPECT_THAT(ticksBetween(-2, -1, 2),
                ElementsAre(DoubleNear(-2, 1e-12), DoubleNear(-1.5, 1e-12), DoubleNear(-1, 1e-12)));
}

TEST(Svg, KeepsOneOrTwoSpotsAndSpotsThatAreTheSame) {
    EXPECT_THAT(simplified({}, 0.1), SizeIs(0));
    const std::vector<Spot> one{{1, 2}};
    EXPECT_THAT(simplified(one, 0.1), SizeIs(1));
    const std::vector<Spot> same(50, Spot{3, 3});
    EXPECT_THAT(simplified(same, 0.1), SizeIs(2));
}

}  // namespace
}  // namespace metier::path_evaluation
