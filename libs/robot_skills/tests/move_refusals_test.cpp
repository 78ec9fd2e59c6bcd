#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "bench.hpp"

namespace metier::robot_skills {
namespace {

using skill::Frame;
using skill::State;
using skill::ValueMap;
using ::testing::HasSubstr;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

struct Refusal {
    std::string name;
    std::string skill;
    ValueMap values;
    Errc code;
    std::string text;
};

/// A refusal's parts must all be in the text; `text` lists them, divided by '|'.
std::vector<std::string> partsOf(const std::string& text) {
    std::vector<std::string> parts(1);
    for (const char c : text) {
        if (c == '|') {
            parts.emplace_back();
        } else {
            parts.back() += c;
        }
    }
    return parts;
}

class RefusedMove : public ::testing::TestWithParam<Refusal> {};

TEST_P(RefusedMove, LeavesTheArmWhereItIsAndTheSkillUsable) {
    Bench bench;
    const auto before = bench.commanded();
    const auto started = bench.start(GetParam().skill, GetParam().values);
    ASSERT_FALSE(started);
    EXPECT_EQ(started.error().code, GetParam().code) << started.error().message;
    for (const auto& part : partsOf(GetParam().text)) {
        EXPECT_THAT(started.error().message, HasSubstr(part));
    }
    bench.steps(5);
    EXPECT_EQ(bench.commanded(), before);
    EXPECT_EQ(bench.program(GetParam().skill).state(), State::ready);
    ValueMap good = GetParam().values;
    for (auto& [parameter, value] : good) {
        value = {};
    }
    ASSERT_TRUE(bench.write(GetParam().skill, good));
    EXPECT_TRUE(bench.start(kJointPtp, {{"TargetJointPosition", std::vector<double>(6, 0.0)},
                                        {"Relative", std::int32_t{1}}}));
}

const Frame kHere{0.0, 0.0, 0.05};

INSTANTIATE_TEST_SUITE_P(
    All, RefusedMove,
    ::testing::Values(
        Refusal{"PoseOutOfReach",
                kCartesianPtp,
                {{"TargetPosition", Frame{2, 0, 0.3}}},
                Errc::unreachable,
                " m"},
        Refusal{"LineOutOfReach",
                kCartesianLinear,
                {{"TargetPosition", Frame{2, 0, 0}}, {"Relative", std::int32_t{1}}},
                Errc::unreachable,
                ""},
        Refusal{"UnknownToolFrame",
                kCartesianPtp,
                {{"TargetPosition", kHere}, {"ToolFrame", std::string("drill")}},
                Errc::not_found,
                "ToolFrame|drill|flange"},
        Refusal{"NotANumber",
                kCartesianPtp,
                {{"TargetPosition", Frame{kNan, 0, 0}}},
                Errc::out_of_range,
                "TargetPosition.x|not finite"},
        Refusal{"JointNotANumber",
                kJointPtp,
                {{"TargetJointPosition", std::vector<double>{0, 0, kNan, 0, 0, 0}}},
                Errc::out_of_range,
                "TargetJointPosition[2]|not finite"},
        Refusal{"JointLimit",
                kJointPtp,
                {{"TargetJointPosition", std::vector<double>{0, 0, 3.5, 0, 0, 0}}},
                Errc::out_of_range,
                "axis 3|3.5|3.14|rad"},
        Refusal{"WrongNumberOfJoints",
                kJointPtp,
                {{"TargetJointPosition", std::vector<double>(7, 0.0)}},
                Errc::out_of_range,
                "TargetJointPosition: 7 elements are more than 6"},
        Refusal{"NoTarget", kJointPtp, {}, Errc::invalid_argument, "TargetJointPosition"},
        Refusal{"WrongNumberOfVelocities",
                kCartesianPtp,
                {{"TargetPosition", kHere}, {"MaxVelocity", std::vector<double>(3, 1.0)}},
                Errc::out_of_range,
                "MaxVelocity: 3 values, expected 6 or all zero"},
        Refusal{"NegativeAcceleration",
                kCartesianLinear,
                {{"TargetPosition", kHere},
                 {"MaxAcceleration", std::vector<double>{1, 1, -1, 1, 1, 1}}},
                Errc::out_of_range,
                "MaxAcceleration[2]: -1 m/s²|under the limit 0"},
        Refusal{"WrongNumberOfBounds",
                kCartesianPtp,
                {{"TargetPosition", kHere}, {"AxisBounds", std::vector<skill::Range>{{-1, 1}}}},
                Errc::out_of_range,
                "AxisBounds: 1 ranges, the arm has 6 axes"},
        Refusal{"ReversedBounds",
                kCartesianPtp,
                {{"TargetPosition", kHere}, {"AxisBounds", std::vector<skill::Range>(6, {1, -1})}},
                Errc::out_of_range,
                "AxisBounds[0]: low 1 rad is over high -1 rad"},
        Refusal{"UnknownRelative",
                kCartesianPtp,
                {{"TargetPosition", kHere}, {"Relative", std::int32_t{3}}},
                Errc::out_of_range,
                "Relative|3|2"},
        Refusal{
            "JointsAlongTheTool",
            kJointPtp,
            {{"TargetJointPosition", std::vector<double>(6, 0.0)}, {"Relative", std::int32_t{2}}},
            Errc::out_of_range,
            "Relative|2|1"},
        Refusal{"BlendRadius",
                kCartesianLinear,
                {{"TargetPosition", kHere}, {"BlendRadius", 0.01}},
                Errc::not_supported,
                "BlendRadius: 0.01 m"},
        Refusal{"NoSpeed",
                kCartesianLinear,
                {{"TargetPosition", kHere}, {"SpeedOverride", 0.0}},
                Errc::out_of_range,
                "SpeedOverride: 0"},
        Refusal{"TooMuchSpeed",
                kCartesianLinear,
                {{"TargetPosition", kHere}, {"SpeedOverride", 1.5}},
                Errc::out_of_range,
                "SpeedOverride: 1.5|1"},
        Refusal{"WrongType",
                kCartesianPtp,
                {{"TargetPosition", std::string("up")}},
                Errc::type_mismatch,
                "TargetPosition"}),
    [](const auto& test) { return test.param.name; });

class RefusingArm : public ::testing::Test {
protected:
    Error refusal() {
        auto started = bench.start(kCartesianLinear, {{"TargetPosition", Frame{0, 0, 0.1}},
                                                      {"Relative", std::int32_t{1}}});
        EXPECT_FALSE(started);
        return started ? Error{} : started.error();
    }

    Bench bench;
};

TEST_F(RefusingArm, SaysThatItIsInAProtectiveStop) {
    bench.arm().protectiveStop("fence opened");
    bench.step();
    EXPECT_EQ(refusal().code, Errc::device_fault);
    EXPECT_EQ(refusal().message, "ur5: fence opened (protective stop)");
}

TEST_F(RefusingArm, SaysThatTheEmergencyStopIsPressed) {
    bench.arm().emergencyStop(joint_simulator::EmergencyStop::pressed);
    bench.step();
    EXPECT_EQ(refusal().code, Errc::device_fault);
    EXPECT_EQ(refusal().message, "ur5: emergency stop pressed (emergency stop)");
}

TEST_F(RefusingArm, SaysThatItIsDisconnected) {
    bench.arm().disconnect();
    bench.step();
    EXPECT_EQ(refusal().code, Errc::device_fault);
    EXPECT_THAT(refusal().message, HasSubstr("no connection to the controller (disconnected)"));
}

TEST(ArmSkills, RefuseAModelWithOtherAxes) {
    const auto model = modelOf("iiwa7");
    const auto arm =
        joint_simulator::JointSimulator::create(joint_simulator::optionsFor(modelOf("ur5")))
            .value();
    const ManualClock clock;
    const auto skills = makeArmSkills({*arm}, model, clock);
    ASSERT_FALSE(skills);
    EXPECT_THAT(skills.error().message, HasSubstr("6 axes"));
    EXPECT_THAT(skills.error().message, HasSubstr("7"));
}

}  // namespace
}  // namespace metier::robot_skills
