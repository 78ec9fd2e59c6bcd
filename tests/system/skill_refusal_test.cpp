// Every kind of bad input to a skill through a real client: the StatusCode, the text with value,
// limit and unit, and that the skill stays as it was.
#include <cmath>
#include <limits>
#include <ostream>

#include "metier/base/numbers.hpp"
#include "served_contract.hpp"

namespace metier::system_tests {
namespace {

using skill::State;
using ::testing::HasSubstr;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kDenormal = std::numeric_limits<double>::denorm_min();
constexpr double kLargest = std::numeric_limits<double>::max();
const skill::Value kGood = std::vector{0.5, -1.0};

/// A value that a parameter refuses, and how.
struct BadWrite {
    const char* name;
    const char* parameter;
    skill::Value value;
    const char* status;
    const char* text;
};

void PrintTo(const BadWrite& write, std::ostream* out) {
    *out << write.name;
}

class BadValue : public ServedContract, public ::testing::WithParamInterface<BadWrite> {
protected:
    BadValue() : skill_(add(served::jointMoveDescription())) { serve(); }

    served::ServedSkill skill_;
};

/// StartWith and Check take the values that a write would, and refuse the rest in the same words.
TEST_P(BadValue, IsRefusedByStartWithAndCheckInTheSameWords) {
    auto handle = openSkill("JointPtpMoveSkill");
    skill::ValueMap values{{"TargetJointPosition", kGood}};
    values.insert_or_assign(GetParam().parameter, GetParam().value);
    const auto refused = handle.startWith({.parameters = values});
    EXPECT_EQ(statusOf(refused), GetParam().status);
    EXPECT_THAT(refused.error().message, HasSubstr(GetParam().text));
    EXPECT_THAT(handle.reasonText(), HasSubstr(GetParam().text));
    const auto report = handle.check(values);
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_FALSE(report->possible);
    EXPECT_THAT(report->reason, HasSubstr(GetParam().text));
    EXPECT_EQ(report->first_failing_fraction, 0.0);
    EXPECT_EQ(*handle.state(), State::ready);
    EXPECT_EQ(served::readAs<double>(client(), skill_, "Options/SpeedOverride"), 1.0)
        << "nothing of it is taken";
    EXPECT_TRUE(handle.startWith({.parameters = {{"TargetJointPosition", kGood}}}));
}

TEST_P(BadValue, IsRefusedWithItsTextAndTheSkillStaysUsable) {
    auto handle = openSkill("JointPtpMoveSkill");
    ASSERT_TRUE(handle.set("TargetJointPosition", kGood));
    ASSERT_TRUE(handle.set("SpeedOverride", 0.5));
    const auto refused = handle.set(GetParam().parameter, GetParam().value);
    EXPECT_EQ(statusOf(refused), GetParam().status);
    EXPECT_THAT(refused.error().message, ::testing::HasSubstr(GetParam().text));
    EXPECT_EQ(*handle.state(), State::ready);
    ASSERT_TRUE(handle.start());
    ASSERT_TRUE(skill_.hand->await("start"));
    EXPECT_EQ(skill_.hand->snapshot().at("TargetJointPosition"), kGood);
    EXPECT_EQ(skill_.hand->snapshot().at("SpeedOverride"), skill::Value(0.5));
}

INSTANTIATE_TEST_SUITE_P(
    Parameters, BadValue,
    ::testing::Values(
        BadWrite{"TextForNumbers", "TargetJointPosition", std::string("home"), "BadTypeMismatch",
                 "TargetJointPosition: Double[] expected, String given"},
        BadWrite{"IntegerForNumber", "SpeedOverride", std::int32_t{1}, "BadTypeMismatch",
                 "SpeedOverride: Double expected, Int32 given"},
        BadWrite{"ScalarForNumbers", "TargetJointPosition", 0.5, "BadTypeMismatch",
                 "TargetJointPosition: Double[] expected, Double given"},
        BadWrite{"NumbersForScalar", "SpeedOverride", std::vector{0.5}, "BadTypeMismatch",
                 "SpeedOverride: Double expected, Double[1] given"},
        BadWrite{"TooManyNumbers", "TargetJointPosition", std::vector{0.1, 0.2, 0.3},
                 "BadOutOfRange", "TargetJointPosition: 3 elements are more than 2"},
        BadWrite{"TooFewNumbers", "TargetJointPosition", std::vector{0.1}, "BadOutOfRange",
                 "TargetJointPosition: 1 elements are fewer than 2"},
        BadWrite{"NoNumbers", "TargetJointPosition", std::vector<double>{}, "BadOutOfRange",
                 "TargetJointPosition: 0 elements are fewer than 2"},
        BadWrite{"NotANumber", "TargetJointPosition", std::vector{0.0, kNan}, "BadOutOfRange",
                 "TargetJointPosition[1]: nan rad is not finite"},
        BadWrite{"Infinite", "SpeedOverride", -kInfinity, "BadOutOfRange",
                 "SpeedOverride: -inf is not finite"},
        BadWrite{"InfiniteInAList", "TargetJointPosition", std::vector{kInfinity, 0.0},
                 "BadOutOfRange", "TargetJointPosition[0]: inf rad is not finite"},
        BadWrite{"TheLargestNumber", "TargetJointPosition", std::vector{0.0, kLargest},
                 "BadOutOfRange", " rad is over the limit 3 rad"},
        BadWrite{"NegativeDenormal", "SpeedOverride", -kDenormal, "BadOutOfRange",
                 "SpeedOverride: -5e-324 is under the limit 0"},
        BadWrite{"ALittleOverTheLimit", "SpeedOverride", std::nextafter(1.0, 2.0), "BadOutOfRange",
                 "SpeedOverride: 1.0000000000000002 is over the limit 1"},
        BadWrite{"ManyNumbers", "TargetJointPosition", std::vector<double>(100'000, 1.0),
                 "BadOutOfRange", "TargetJointPosition: 100000 elements are more than 2"},
        BadWrite{"NotANumberForMaxVelocity", "MaxVelocity", std::vector{1.0, kNan}, "BadOutOfRange",
                 "MaxVelocity[1]: nan rad/s is not finite"},
        BadWrite{"BooleanForNumber", "SpeedOverride", true, "BadTypeMismatch",
                 "SpeedOverride: Double expected, Boolean given"},
        BadWrite{"NumberForText", "ToolFrame", 1.0, "BadTypeMismatch",
                 "ToolFrame: String expected, Double given"},
        BadWrite{"TextsForText", "ToolFrame", std::vector<std::string>{"flange"}, "BadTypeMismatch",
                 "ToolFrame: String expected, String[1] given"},
        BadWrite{"OverTheLimit", "TargetJointPosition", std::vector{3.5, 0.0}, "BadOutOfRange",
                 "TargetJointPosition[0]: 3.5 rad is over the limit 3 rad"},
        BadWrite{"UnderTheLimit", "MaxVelocity", std::vector{1.0, -0.5}, "BadOutOfRange",
                 "MaxVelocity[1]: -0.5 rad/s is under the limit 0 rad/s"}),
    [](const auto& test) { return std::string(test.param.name); });

class Refusal : public ServedContract {
protected:
    Refusal()
        : skill_(add(served::jointMoveDescription())), line_(add(served::linearMoveDescription())) {
        serve();
    }

    served::ServedSkill skill_;
    served::ServedSkill line_;
};

/// A value at the edge of what is allowed, which arrives as it was sent.
class EdgeValue : public ServedContract,
                  public ::testing::WithParamInterface<std::pair<const char*, skill::Value>> {
protected:
    EdgeValue() : skill_(add(served::jointMoveDescription())) { serve(); }

    void expectStartedWith(const skill::Value& value) {
        ASSERT_TRUE(skill_.hand->await("start"));
        EXPECT_EQ(skill_.hand->snapshot().at(GetParam().first), value);
        skill_.hand->execution().finish();
    }

    served::ServedSkill skill_;
};

TEST_P(EdgeValue, IsTakenByWriteStartWithAndCheck) {
    const auto& [name, value] = GetParam();
    auto handle = openSkill("JointPtpMoveSkill");
    ASSERT_TRUE(handle.set("TargetJointPosition", kGood));
    const auto written = handle.set(name, value);
    ASSERT_TRUE(written) << written.error().message;
    ASSERT_TRUE(handle.start());
    expectStartedWith(value);
    ASSERT_TRUE(handle.awaitState(State::ready, soon()));
    skill::ValueMap values{{"TargetJointPosition", kGood}};
    values.insert_or_assign(name, value);
    EXPECT_TRUE(handle.check(values).value().possible);
    ASSERT_TRUE(handle.startWith({.parameters = values}));
    expectStartedWith(value);
}

INSTANTIATE_TEST_SUITE_P(
    Parameters, EdgeValue,
    ::testing::Values(std::pair<const char*, skill::Value>("SpeedOverride", kDenormal),
                      std::pair<const char*, skill::Value>("SpeedOverride", -0.0),
                      std::pair<const char*, skill::Value>("SpeedOverride", 1.0),
                      std::pair<const char*, skill::Value>("TargetJointPosition",
                                                           std::vector{-3.0, 3.0}),
                      std::pair<const char*, skill::Value>("TargetJointPosition",
                                                           std::vector{-kDenormal, kDenormal}),
                      std::pair<const char*, skill::Value>("ToolFrame", std::string())));

TEST_F(Refusal, OfNullForAParameterThatIsNeededFollowsAtStart) {
    auto handle = openSkill("JointPtpMoveSkill");
    ASSERT_TRUE(handle.set("TargetJointPosition", kGood));
    ASSERT_TRUE(handle.set("TargetJointPosition", {})) << "Null asks for the default";
    EXPECT_EQ(statusOf(handle.start()), "BadInvalidArgument");
    const skill::ValueMap null{{"TargetJointPosition", {}}};
    EXPECT_EQ(statusOf(handle.startWith({.parameters = null})), "BadInvalidArgument");
    EXPECT_EQ(handle.check(null).value().reason, "a value is needed for TargetJointPosition");
}

TEST_F(Refusal, OfNullIsNoneWhereThereIsADefault) {
    auto handle = openSkill("JointPtpMoveSkill");
    ASSERT_TRUE(
        handle.startWith({.parameters = {{"TargetJointPosition", kGood}, {"SpeedOverride", {}}}}));
    ASSERT_TRUE(skill_.hand->await("start"));
    EXPECT_EQ(skill_.hand->snapshot().at("SpeedOverride"), skill::Value(1.0));
}

TEST_F(Refusal, OfAParameterThatStartWithDoesNotKnowOrIsGivenTwice) {
    auto handle = openSkill("JointPtpMoveSkill");
    const skill::ValueMap unknown{{"TargetJointPosition", kGood}, {"Target", kGood}};
    EXPECT_EQ(statusOf(handle.startWith({.parameters = unknown})), "BadInvalidArgument");
    EXPECT_EQ(handle.reasonText(), "no parameter Target");
    EXPECT_EQ(handle.check(unknown).value().reason, "no parameter Target");
    const opcua::KeyValue speed{{0, "SpeedOverride"}, opcua::Value::of(0.5)};
    const auto twice = client().call(skill_.id, skill_.node("Check"),
                                     {opcua::Value::of(std::vector{speed, speed})});
    ASSERT_TRUE(twice) << twice.error().message;
    EXPECT_EQ(twice->outputs.at(0).as<bool>(), false);
    EXPECT_EQ(twice->outputs.at(1).as<std::string>(), "SpeedOverride is given twice");
}

/// A matrix is no list: 2 x 1 values for a list of two.
TEST_F(Refusal, OfAValueOfAnotherRank) {
    const auto matrix = opcua::Value::ofRows({{0.5}, {-1.0}});
    EXPECT_EQ(served::write(client(), skill_, "ParameterSet/TargetJointPosition", matrix),
              "BadTypeMismatch");
    const opcua::KeyValue target{{0, "TargetJointPosition"}, matrix};
    const auto report =
        client().call(skill_.id, skill_.node("Check"), {opcua::Value::of(std::vector{target})});
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_EQ(report->outputs.at(0).as<bool>(), false);
    EXPECT_THAT(report->outputs.at(1).as<std::string>().value(), HasSubstr("TargetJointPosition"));
}

TEST_F(Refusal, OfAnOptionForLossOrALeaseThatDoesNotExistNamesItsLimits) {
    const auto started =
        client().call(skill_.id, skill_.node("StartWith"),
                      {opcua::Value::of(""), opcua::Value::of(std::vector<opcua::KeyValue>{}),
                       opcua::Value::of(std::int32_t{7}), opcua::Value::of(std::uint64_t{0}),
                       opcua::Value::of(UtcTime{})});
    EXPECT_EQ(statusOf(started), "BadOutOfRange");
    EXPECT_EQ(openSkill("JointPtpMoveSkill").reasonText(), "OnOwnerLoss: 7 is not within 0 to 3");
}

TEST_F(Refusal, OfAFrameThatIsNotFiniteNamesThePart) {
    auto handle = openSkill("CartesianLinearMoveSkill");
    EXPECT_EQ(statusOf(handle.set("TargetPosition", skill::Frame{.z = kNan})), "BadOutOfRange");
    EXPECT_EQ(handle.reasonText(), "TargetPosition.z: nan is not finite");
}

TEST_F(Refusal, OfARangeThatIsUpsideDownNamesBothEnds) {
    auto handle = openSkill("CartesianLinearMoveSkill");
    const std::vector bounds{skill::Range{-1.0, 1.0}, skill::Range{0.5, -0.5}};
    EXPECT_EQ(statusOf(handle.set("AxisBounds", bounds)), "BadOutOfRange");
    EXPECT_EQ(handle.reasonText(), "AxisBounds[1]: low 0.5 rad is over high -0.5 rad");
}

TEST_F(Refusal, OfAStartNamesEveryParameterThatIsMissing) {
    auto handle = openSkill("JointPtpMoveSkill");
    EXPECT_EQ(statusOf(handle.start()), "BadInvalidArgument");
    EXPECT_EQ(handle.reasonText(), "a value is needed for TargetJointPosition");
    EXPECT_EQ(*handle.state(), State::ready);
}

TEST_F(Refusal, OfAStartThatTheDeviceCannotDoKeepsWhatWasWritten) {
    auto handle = openSkill("JointPtpMoveSkill");
    ASSERT_TRUE(handle.set("TargetJointPosition", kGood));
    skill_.hand->refuseStart({Errc::unreachable, "axis 1 would need 3.4 rad, limit 2.9 rad"});
    const auto refused = handle.start();
    EXPECT_EQ(statusOf(refused), opcua::statusFrom(Errc::unreachable).name());
    EXPECT_THAT(refused.error().message, HasSubstr("axis 1 would need 3.4 rad, limit 2.9 rad"));
    EXPECT_EQ(
        served::readAs<std::vector<double>>(client(), skill_, "ParameterSet/TargetJointPosition"),
        (std::vector{0.5, -1.0}));
    EXPECT_EQ(*handle.state(), State::ready);
}

TEST_F(Refusal, OfAnotherSessionTellsWhyAndEndsWithStart) {
    auto mine = openSkill("JointPtpMoveSkill");
    const auto other_client = connect("other");
    auto other = openSkill(*other_client, "JointPtpMoveSkill");
    ASSERT_TRUE(mine.set("TargetJointPosition", kGood));
    EXPECT_EQ(statusOf(other.set("SpeedOverride", 0.5)), "BadLocked");
    EXPECT_EQ(other.reasonText(),
              "another session has configured the skill and not started it yet");
    EXPECT_EQ(statusOf(other.start()), "BadLocked");
    ASSERT_TRUE(mine.start());
    skill_.hand->execution().finish();
    ASSERT_TRUE(mine.awaitState(State::ready, soon()));
    EXPECT_EQ(statusOf(other.set("SpeedOverride", 0.5)), "Good");
}

TEST_F(Refusal, OfAnUnknownParameterNamesTheKnownOnes) {
    auto handle = openSkill("JointPtpMoveSkill");
    const auto refused = handle.set("Target", kGood);
    EXPECT_EQ(statusOf(refused), "BadNoMatch");
    EXPECT_THAT(refused.error().message, HasSubstr("no parameter 'Target'; it has: "));
    EXPECT_THAT(refused.error().message, HasSubstr("TargetJointPosition"));
}

TEST_F(Refusal, OfAMethodWithArgumentsItDoesNotHaveChangesNothing) {
    const auto start = skill_.node("Start");
    const auto refused = client().call(skill_.id, start, {opcua::Value::of(1.0)});
    EXPECT_EQ(statusOf(refused), "BadTooManyArguments");
    EXPECT_EQ(textAt(skill_, "CurrentState"), "Ready");
}

TEST_F(Refusal, IsForgottenOnceACommandIsAccepted) {
    auto handle = openSkill("JointPtpMoveSkill");
    EXPECT_FALSE(handle.set("SpeedOverride", 2.0));
    EXPECT_EQ(handle.reasonText(), "SpeedOverride: 2 is over the limit 1");
    EXPECT_TRUE(handle.set("SpeedOverride", 1.0));
    EXPECT_EQ(handle.reasonText(), "");
}

}  // namespace
}  // namespace metier::system_tests
