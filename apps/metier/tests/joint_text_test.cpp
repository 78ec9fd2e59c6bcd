#include "joint_text.hpp"

#include <gmock/gmock.h>

#include <numbers>

#include "metier/motion/frame.hpp"

namespace metier::app {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

motion::RobotModel ur5() {
    return motion::RobotModel::load(std::string(METIER_MODELS_DIR) + "/ur5.toml").value();
}

TEST(JointText, TakesNumbersAsWordsOrWithCommas) {
    const std::vector<std::string> words{"-1.57", "2e-3,+.5", " -.25"};
    EXPECT_THAT(parseNumbers(words, "x").value(), ElementsAre(-1.57, 0.002, 0.5, -0.25));
}

TEST(JointText, RefusesWhatIsNoFiniteNumberWithItsPlace) {
    for (const char* word : {"nan", " -inf", "1e999", "1,5x", "", "1,,2", "0x10", "+", "1 2"}) {
        const std::vector<std::string> words{"0", word};
        const auto values = parseNumbers(words, "joint position");
        ASSERT_FALSE(values) << word;
        EXPECT_EQ(values.error().code, Errc::invalid_argument);
        EXPECT_THAT(values.error().message, HasSubstr("is not a finite number")) << word;
    }
    EXPECT_THAT(parseNumbers({{"0", "nan"}}, "joint position").error().message,
                HasSubstr("joint position 2: 'nan'"));
}

TEST(JointText, AsksForOneValueOfEachAxis) {
    EXPECT_TRUE(parseJoints(ur5(), {{"0,0,0,0,0,0"}}, "start"));
    for (const char* joints : {"0,0,0,0,0", "0,0,0,0,0,0,0"}) {
        EXPECT_THAT(parseJoints(ur5(), {{joints}}, "start").error().message,
                    ::testing::AllOf(HasSubstr("start: "), HasSubstr("ur5 has 6 axes")));
    }
    EXPECT_THAT(parsePose({{"1,2,3"}}, "target").error().message,
                HasSubstr("target: 3 values given, a pose has 6"));
}

TEST(JointText, WritesOneOfTwoEqualQuaternionsAndNoNegativeZero) {
    auto pose = motion::toPose({0.5, -1e-17, 0, std::numbers::pi, 0, 0});
    pose.rotation.coeffs() *= -1;
    EXPECT_EQ(toJson(pose)["quaternion"]["x"], 1.0);
    EXPECT_THAT(toText(pose), HasSubstr("y 0.000000000000  z 0.0"));
    EXPECT_EQ(toText(motion::JointVector{-1e-9, 0.5}), "0.000000, 0.500000");
}

TEST(JointText, JsonKeepsEveryBit) {
    const auto pose = motion::toPose({1.0 / 3, -0.1, 1e-17, 0.7, -0.2, 3.0});
    const auto back = nlohmann::json::parse(toJson(pose).dump());
    EXPECT_EQ(back["position"]["x"].get<double>(), 1.0 / 3);
    EXPECT_EQ(back["quaternion"]["z"].get<double>(), pose.rotation.z());
}

TEST(JointText, TakesOneSignOnly) {
    EXPECT_THAT(parseNumbers({{"+1", " +2", "-3"}}, "x").value(), ElementsAre(1, 2, -3));
    for (const char* word : {"++1", "+-1", "-+1", "--1", "+ 1", "+ +1"}) {
        EXPECT_FALSE(parseNumbers({{word}}, "x")) << word;
    }
}

TEST(JointText, AWordThatEndsWithACommaLacksANumber) {
    const auto refused = parseNumbers({{"1,2,"}}, "axis bound");
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr("axis bound 3: '' is not a finite number"));
    EXPECT_TRUE(parseNumbers({}, "x").value().empty());
}

TEST(JointText, APoseHasMetresAndRadiansInItsRefusal) {
    const auto refused = parsePose({{"1,2,3,4,5,6,7"}}, "target");
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().message,
              "target: 7 values given, a pose has 6: x y z in m, a b c in rad");
    const auto joints = parseJoints(ur5(), {{"1"}}, "start");
    EXPECT_EQ(joints.error().message,
              "start: 1 values given, ur5 has 6 axes: one value for each, rad");
}

TEST(JointText, APoseIsReadAsItIsWritten) {
    const auto pose = parsePose({{"0.1,-0.2,0.3,0.4,-0.5,0.6"}}, "target").value();
    const auto json = toJson(pose);
    EXPECT_NEAR(json["position"]["y"].get<double>(), -0.2, 1e-15);
    EXPECT_NEAR(json["rotation"]["a"].get<double>(), 0.4, 1e-12);
    EXPECT_NEAR(json["rotation"]["c"].get<double>(), 0.6, 1e-12);
    EXPECT_GT(json["quaternion"]["w"].get<double>(), 0.0);
}

}  // namespace
}  // namespace metier::app
