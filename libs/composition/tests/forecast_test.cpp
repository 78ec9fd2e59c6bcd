#include "check/forecast.hpp"

#include <gtest/gtest.h>

namespace metier::composition {
namespace {

using Place = std::vector<double>;

Forecast with(skill::ArmPositions arms) {
    Forecast forecast;
    forecast.move(arms);
    return forecast;
}

TEST(Forecast, LeavesAnArmThatNoStepHasMovedWhereItStands) {
    const auto forecast = with({{"left", {1.0}}});
    EXPECT_EQ(forecast.place("left"), Place{1.0});
    EXPECT_FALSE(forecast.place("right"));
    EXPECT_FALSE(forecast.isLost("right"));
    EXPECT_FALSE(forecast.anyLost());
}

TEST(Forecast, KnowsOfNoArmOnceAnyMayHaveMoved) {
    auto forecast = with({{"left", {1.0}}, {std::string(skill::kEveryOtherArm), {}}});
    EXPECT_TRUE(forecast.isLost("right"));
    EXPECT_TRUE(forecast.anyLost());
    EXPECT_EQ(forecast.place("left"), Place{1.0}) << "that one is named";
    forecast.move({{std::string(skill::kEveryOtherArm), {}}});
    EXPECT_TRUE(forecast.isLost("left"));
    forecast.move({{"left", {2.0}}});
    EXPECT_EQ(forecast.place("left"), Place{2.0}) << "found again";
    EXPECT_TRUE(forecast.isLost("right"));
}

TEST(Forecast, OfOneOfTwoWaysKeepsOnlyPlacesInWhichBothEnd) {
    const auto after = either(with({{"left", {1.0}}, {"right", {1.0}}}),
                              with({{"left", {1.0 + 1e-9}}, {"right", {2.0}}, {"third", {3.0}}}));
    EXPECT_EQ(after.place("left"), Place{1.0});
    EXPECT_TRUE(after.isLost("right"));
    EXPECT_TRUE(after.isLost("third")) << "one way leaves it where it stands now";
}

TEST(Forecast, OfTwoWaysAtTheSameTimeHasTheArmsOfBoth) {
    const auto begin = with({{"left", {0.0}}, {"third", {0.5}}});
    auto one = begin;
    one.move({{"left", {1.0}}});
    auto other = begin;
    other.move({{"right", {2.0}}});
    const auto after = both(begin, one, other);
    EXPECT_EQ(after.place("left"), Place{1.0});
    EXPECT_EQ(after.place("right"), Place{2.0});
    EXPECT_EQ(after.place("third"), Place{0.5});
    other.move({{"left", {3.0}}});
    EXPECT_TRUE(both(begin, one, other).isLost("left")) << "both move it";
}

TEST(Forecast, ComparesPlacesOfArms) {
    EXPECT_TRUE(samePlaces(with({{"left", {1.0}}}), with({{"left", {1.0}}})));
    EXPECT_FALSE(samePlaces(with({{"left", {1.0}}}), with({{"left", {1.1}}})));
    EXPECT_FALSE(samePlaces(with({{"left", {1.0}}}), with({})));
    EXPECT_TRUE(samePlaces(with({{"left", {}}}), with({{"left", {}}}))) << "not known in both";
}

}  // namespace
}  // namespace metier::composition
