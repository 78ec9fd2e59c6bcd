// Joints of a model and axes of a server, which may be in another order.
#include "remote_arm/axis_order.hpp"

#include <gmock/gmock.h>

namespace metier::client {
namespace {

using ::testing::HasSubstr;

using Places = std::vector<JointPlace>;

std::string refusal(const AxisNames& names) {
    const auto places = placesOf(names);
    return places ? "not refused" : places.error().message;
}

TEST(AxisOrder, FollowsTheNamesOfTheJoints) {
    const auto places =
        placesOf({.joints = {"base", "shoulder", "elbow"}, .axes = {"elbow", "base", "shoulder"}});
    ASSERT_TRUE(places) << places.error().message;
    EXPECT_EQ(*places, (Places{{1, 1}, {2, 2}, {0, 0}}));
}

TEST(AxisOrder, CountsAxesByTheNumbersInTheirNames) {
    const auto places =
        placesOf({.joints = {"base", "shoulder", "elbow"}, .axes = {"Axis_2", "Axis_3", "Axis_1"}});
    ASSERT_TRUE(places) << places.error().message;
    EXPECT_EQ(*places, (Places{{2, 0}, {0, 1}, {1, 2}})) << "arrays are in the order of numbers";
}

TEST(AxisOrder, FollowsTheGivenOrderOfTheArrays) {
    const auto places = placesOf({.joints = {"base", "shoulder", "elbow"},
                                  .axes = {"Swing", "Lift", "Turn"},
                                  .array_order = {"elbow", "shoulder", "base"}});
    ASSERT_TRUE(places) << places.error().message;
    EXPECT_EQ(*places, (Places{{2, 2}, {1, 1}, {0, 0}}));
}

TEST(AxisOrder, FindsAxesByNameAlsoIfTheArraysHaveAnotherOrder) {
    const auto places = placesOf({.joints = {"base", "shoulder", "elbow"},
                                  .axes = {"base", "shoulder", "elbow"},
                                  .array_order = {"elbow", "shoulder", "base"}});
    ASSERT_TRUE(places) << places.error().message;
    EXPECT_EQ(*places, (Places{{0, 2}, {1, 1}, {2, 0}}));
}

TEST(AxisOrder, FindsNumberedAxesOfArraysInAGivenOrder) {
    const auto places = placesOf({.joints = {"base", "shoulder", "elbow"},
                                  .axes = {"A3", "A1", "A2"},
                                  .array_order = {"elbow", "shoulder", "base"}});
    ASSERT_TRUE(places) << places.error().message;
    EXPECT_EQ(*places, (Places{{0, 2}, {2, 1}, {1, 0}}));
}

TEST(AxisOrder, IsNotGuessed) {
    const std::vector<std::string> joints{"base", "shoulder"};
    EXPECT_THAT(refusal({joints, {"Turn", "Lift"}}), HasSubstr("axes are Turn, Lift; "));
    EXPECT_THAT(refusal({joints, {"A1", "A1"}}), HasSubstr("must be given"));
    EXPECT_THAT(refusal({joints, {"A0", "A1"}}), HasSubstr("must be given"));
    EXPECT_THAT(refusal({joints, {"A1", "A99999999999999999999999"}}), HasSubstr("must be given"));
    EXPECT_THAT(refusal({joints, {"base", "base"}}), HasSubstr("must be given"));
}

TEST(AxisOrder, IsRefusedWithAnotherNumberOfAxesAndWithOtherNames) {
    const std::vector<std::string> joints{"base", "shoulder"};
    EXPECT_THAT(refusal({joints, {"A1", "A2", "A3"}}), HasSubstr("numbers of axes differ"));
    EXPECT_THAT(refusal({joints, {"A1", "A2"}, {"base", "base"}}), HasSubstr("no order"));
    EXPECT_THAT(refusal({joints, {"A1", "A2"}, {"base"}}), HasSubstr("no order"));
    EXPECT_THAT(refusal({joints, {"A1", "A2"}, {"base", "Lift"}}), HasSubstr("\"base, Lift\""));
}

}  // namespace
}  // namespace metier::client
