#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "served_skills.hpp"

namespace metier::opcua_skill::testing {
namespace {

using opcua::Value;
using ::testing::HasSubstr;

class Parameters : public ServedSkills {
protected:
    Parameters()
        : move_(add(jointMoveDescription())),
          line_(add(linearMoveDescription())),
          stream_(add(streamDescription())) {
        serve();
        client_ = connect();
    }

    std::string write(std::string_view path, const Value& value) {
        return testing::write(*client_, move_, path, value);
    }
    std::string reason() { return read(*client_, move_, "ReasonText"); }

    static constexpr const char* kTarget = "ParameterSet/TargetJointPosition";

    ServedSkill move_;
    ServedSkill line_;
    ServedSkill stream_;
    std::unique_ptr<opcua::Client> client_;
};

TEST_F(Parameters, AnAcceptedValueIsReadBack) {
    EXPECT_EQ(write(kTarget, Value::of(std::vector{0.5, -1.0})), "Good");
    EXPECT_EQ(readAs<std::vector<double>>(*client_, move_, kTarget), (std::vector{0.5, -1.0}));
}

TEST_F(Parameters, ARefusedValueLeavesTheOldOne) {
    ASSERT_EQ(write(kTarget, Value::of(std::vector{0.5, -1.0})), "Good");
    EXPECT_EQ(write(kTarget, Value::of(std::vector{0.5, 3.5})), "BadOutOfRange");
    EXPECT_THAT(reason(), HasSubstr("3.5"));
    EXPECT_THAT(reason(), HasSubstr("rad"));
    EXPECT_EQ(readAs<std::vector<double>>(*client_, move_, kTarget), (std::vector{0.5, -1.0}));
}

TEST_F(Parameters, RefusesAWrongType) {
    EXPECT_EQ(write(kTarget, Value::of("far away")), "BadTypeMismatch");
    EXPECT_EQ(write("Options/SpeedOverride", Value::of(std::int32_t{1})), "BadTypeMismatch");
}

TEST_F(Parameters, RefusesAWrongRank) {
    EXPECT_EQ(write(kTarget, Value::of(0.5)), "BadTypeMismatch");
    EXPECT_EQ(write("Options/SpeedOverride", Value::of(std::vector{0.5})), "BadTypeMismatch");
}

TEST_F(Parameters, RefusesAWrongLength) {
    EXPECT_EQ(write(kTarget, Value::of(std::vector{0.1, 0.2, 0.3})), "BadOutOfRange");
}

TEST_F(Parameters, RefusesWhatIsNotFinite) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const double infinity = std::numeric_limits<double>::infinity();
    EXPECT_EQ(write(kTarget, Value::of(std::vector{nan, 0.0})), "BadOutOfRange");
    EXPECT_EQ(write("Options/SpeedOverride", Value::of(infinity)), "BadOutOfRange");
    EXPECT_EQ(readAs<double>(*client_, move_, "Options/SpeedOverride"), 1.0);
}

TEST_F(Parameters, NullIsTheDefault) {
    ASSERT_EQ(write("Options/SpeedOverride", Value::of(0.25)), "Good");
    EXPECT_EQ(write("Options/SpeedOverride", Value()), "Good");
    EXPECT_EQ(readAs<double>(*client_, move_, "Options/SpeedOverride"), 1.0);
}

TEST_F(Parameters, AnotherSessionIsLockedOut) {
    ASSERT_EQ(write(kTarget, Value::of(std::vector{0.5, -1.0})), "Good");
    EXPECT_EQ(readAs<opcua::LocalizedText>(*client_, move_, "ReadySubStates/CurrentState").text,
              "ReadyConfigured");
    const auto other = connect("other");
    EXPECT_EQ(testing::write(*other, move_, kTarget, Value::of(std::vector{1.0, 1.0})),
              "BadLocked");
    EXPECT_EQ(call(*other, move_, "Start"), "BadLocked");
    EXPECT_EQ(call(*client_, move_, "Start"), "Good");
}

TEST_F(Parameters, TheBindingEndsWithItsSession) {
    ASSERT_EQ(write(kTarget, Value::of(std::vector{0.5, -1.0})), "Good");
    ASSERT_TRUE(client_->close());
    const auto other = connect("other");
    EXPECT_EQ(testing::write(*other, move_, kTarget, Value::of(std::vector{1.0, 1.0})), "Good");
}

TEST_F(Parameters, StartTakesOneSnapshotOfWhatWasWritten) {
    ASSERT_EQ(write(kTarget, Value::of(std::vector{0.5, -1.0})), "Good");
    ASSERT_EQ(write("Options/SpeedOverride", Value::of(0.5)), "Good");
    ASSERT_EQ(call(*client_, move_, "Start"), "Good");
    ASSERT_TRUE(move_.hand->await("start"));
    const auto snapshot = move_.hand->snapshot();
    EXPECT_EQ(snapshot.at("TargetJointPosition"), skill::Value(std::vector{0.5, -1.0}));
    EXPECT_EQ(snapshot.at("SpeedOverride"), skill::Value(0.5));
}

TEST_F(Parameters, StartNamesTheParameterThatIsMissing) {
    EXPECT_EQ(call(*client_, move_, "Start"), "BadInvalidArgument");
    EXPECT_THAT(reason(), HasSubstr("TargetJointPosition"));
}

TEST_F(Parameters, AFrameAndItsPartsAreOneValue) {
    const opcua::ThreeDFrame frame{0.1, 0.2, 0.3, 0.4, 0.5, 0.6};
    const auto line = [&](std::string_view path, const Value& value) {
        return testing::write(*client_, line_, path, value);
    };
    ASSERT_EQ(line("ParameterSet/TargetPosition", Value::of(frame)), "Good");
    const std::string parts = "ParameterSet/TargetPosition/";
    EXPECT_EQ(readAs<double>(*client_, line_, parts + "CartesianCoordinates/Z"), 0.3);
    EXPECT_EQ((readAs<opcua::ThreeDOrientation>(*client_, line_, parts + "Orientation")),
              (opcua::ThreeDOrientation{0.4, 0.5, 0.6}));
    ASSERT_EQ(line(parts + "CartesianCoordinates/X", Value::of(-1.0)), "Good");
    ASSERT_EQ(line(parts + "Orientation", Value::of(opcua::ThreeDOrientation{})), "Good");
    EXPECT_EQ((readAs<opcua::ThreeDFrame>(*client_, line_, "ParameterSet/TargetPosition")),
              (opcua::ThreeDFrame{-1.0, 0.2, 0.3, 0.0, 0.0, 0.0}));
}

TEST_F(Parameters, NoPartOfAFrameIsOutsideTheRangeOfItsNode) {
    const auto line = [&](std::string_view path, const Value& value) {
        return testing::write(*client_, line_, path, value);
    };
    const std::string target = "ParameterSet/TargetPosition";
    const opcua::ThreeDFrame near{0.1, 0.2, 0.3, 0.4, 0.5, 0.6};
    ASSERT_EQ(line(target, Value::of(near)), "Good");
    EXPECT_EQ(line(target, Value::of(opcua::ThreeDFrame{0.1, 10.5, 0.3, 0, 0, 0})),
              "BadOutOfRange");
    EXPECT_EQ(read(*client_, line_, "ReasonText"), "TargetPosition.y: 10.5 is outside -10 to 10 m");
    EXPECT_EQ(line(target + "/CartesianCoordinates/X", Value::of(1e300)), "BadOutOfRange");
    EXPECT_EQ(line(target + "/CartesianCoordinates",
                   Value::of(opcua::ThreeDCartesianCoordinates{0, 0, -11})),
              "BadOutOfRange");
    EXPECT_EQ(line(target + "/Orientation/C", Value::of(7.0)), "BadOutOfRange");
    EXPECT_THAT(read(*client_, line_, "ReasonText"), HasSubstr("TargetPosition.c: 7 is outside"));
    EXPECT_EQ((readAs<opcua::ThreeDFrame>(*client_, line_, target)), near);
    EXPECT_EQ(line(target + "/CartesianCoordinates/X", Value::of(-10.0)), "Good");
}

TEST_F(Parameters, BoundsTravelAsRanges) {
    const std::vector bounds{opcua::Range{-1.0, 1.0}, opcua::Range{-2.0, 0.5}};
    EXPECT_EQ(testing::write(*client_, line_, "ParameterSet/AxisBounds", Value::of(bounds)),
              "Good");
    EXPECT_EQ(readAs<std::vector<opcua::Range>>(*client_, line_, "ParameterSet/AxisBounds"),
              bounds);
}

TEST_F(Parameters, UnitAndRangeAreThoseOfTheSkill) {
    const auto target = move_.node(kTarget);
    const auto unit = client_->translate(target, {{0, "EngineeringUnits"}});
    const auto range = client_->translate(target, {{0, "EURange"}});
    ASSERT_TRUE(unit && range);
    EXPECT_EQ(client_->read(*unit)->as<opcua::EuInformation>()->display_name.text, "rad");
    EXPECT_EQ(*client_->read(*range)->as<opcua::Range>(), (opcua::Range{-3.0, 3.0}));
}

TEST_F(Parameters, ALiveParameterReachesTheWorkWithItsSourceTimeWhileRunning) {
    ASSERT_EQ(call(*client_, stream_, "Start"), "Good");
    ASSERT_TRUE(stream_.hand->await("start"));
    const auto written = client_->write(stream_.node(kTarget), Value::of(std::vector{0.125, 0.0}),
                                        UtcTime(std::chrono::seconds(1'700'000'000)));
    EXPECT_TRUE(written) << written.error().message;
    EXPECT_TRUE(stream_.hand->await("TargetJointPosition=[0.125, 0] at 1700000000"));
}

TEST_F(Parameters, AnyOtherParameterIsClosedWhileRunning) {
    ASSERT_EQ(write(kTarget, Value::of(std::vector{0.5, -1.0})), "Good");
    ASSERT_EQ(call(*client_, move_, "Start"), "Good");
    EXPECT_EQ(write(kTarget, Value::of(std::vector{0.0, 0.0})), "BadInvalidState");
}

}  // namespace
}  // namespace metier::opcua_skill::testing
