#include "metier/skill/field_list.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace metier::skill {
namespace {

using ::testing::HasSubstr;

struct Grasp {
    double force = 0;
    Frame pose{};
    std::optional<double> width{};
    std::vector<Range> bounds{};
};

FieldList<Grasp> graspFields() {
    FieldList<Grasp> fields;
    fields
        .add(&Grasp::force,
             {.name = "Force", .unit = kNewton, .range = Range{5, 80}, .default_value = 20.0})
        .add(&Grasp::pose, {.name = "Pose"})
        .add(&Grasp::width, {.name = "Width", .unit = kMetre, .range = Range{0, 0.11}})
        .add(&Grasp::bounds, {.name = "Bounds", .default_value = std::vector<Range>{}});
    return fields;
}

TEST(FieldList, TakesTheTypesFromTheMembers) {
    const auto list = graspFields();
    const auto& fields = list.fields();
    ASSERT_EQ(fields.size(), 4U);
    EXPECT_EQ(fields[0].type, ValueType::number);
    EXPECT_EQ(fields[1].type, ValueType::frame);
    EXPECT_EQ(fields[2].type, ValueType::number);
    EXPECT_EQ(fields[3].type, ValueType::ranges);
    EXPECT_FALSE(fields[0].optional);
    EXPECT_TRUE(fields[2].optional);
}

TEST(FieldList, ReadsAStructWithDefaultsForWhatIsMissing) {
    const auto grasp = graspFields().read({{"Pose", Frame{.x = 0.4}}, {"Force", Value{}}});
    ASSERT_TRUE(grasp);
    EXPECT_EQ(grasp->force, 20.0);
    EXPECT_EQ(grasp->pose, Frame{.x = 0.4});
    EXPECT_FALSE(grasp->width);
}

TEST(FieldList, ReadsAnOptionalThatIsGiven) {
    const auto grasp = graspFields().read({{"Pose", Frame{}}, {"Width", 0.05}});
    ASSERT_TRUE(grasp);
    EXPECT_EQ(grasp->width, 0.05);
}

TEST(FieldList, RefusesABadValueByName) {
    const auto grasp = graspFields().read({{"Pose", Frame{}}, {"Width", 0.2}});
    ASSERT_FALSE(grasp);
    EXPECT_EQ(grasp.error().code, Errc::out_of_range);
    EXPECT_THAT(grasp.error().message, HasSubstr("Width: 0.2 m"));
}

TEST(FieldList, RefusesAMissingValueByName) {
    const auto grasp = graspFields().read({});
    ASSERT_FALSE(grasp);
    EXPECT_EQ(grasp.error().code, Errc::invalid_argument);
    EXPECT_THAT(grasp.error().message, HasSubstr("Pose"));
}

TEST(FieldList, PassesOverNamesThatAreNotDeclared) {
    EXPECT_TRUE(graspFields().read({{"Pose", Frame{}}, {"Colour", std::string("red")}}));
}

TEST(FieldList, WritesWhatItReads) {
    const ValueMap values{{"Force", 30.0},
                          {"Pose", Frame{.z = 1}},
                          {"Width", 0.1},
                          {"Bounds", std::vector<Range>{{0, 1}}}};
    EXPECT_EQ(graspFields().write(*graspFields().read(values)), values);
}

TEST(FieldList, WritesNullForAnEmptyOptional) {
    EXPECT_EQ(graspFields().write(Grasp{}).at("Width"), Value{});
}

}  // namespace
}  // namespace metier::skill
