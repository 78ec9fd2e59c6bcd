#include "metier/server/property_wish.hpp"

#include <gmock/gmock.h>

namespace metier::server {
namespace {

using ::testing::ElementsAre;

SurveyedSkill welder() {
    SurveyedSkill skill;
    skill.properties = {{"ControlFrequency", 125.0, "Hz"},
                        {"Process", std::string("MIG"), ""},
                        {"Calibrated", true, ""}};
    return skill;
}

Verdict judged(std::string_view wish) {
    return judgeProperties({parsePropertyWish(wish).value()}, welder());
}

TEST(PropertyWish, ComparesNumbers) {
    EXPECT_TRUE(judged("ControlFrequency>=100").fits);
    EXPECT_TRUE(judged("ControlFrequency <= 125").fits);
    EXPECT_TRUE(judged("ControlFrequency=125").fits);
    EXPECT_FALSE(judged("ControlFrequency>=125.5").fits);
    EXPECT_THAT(judged("ControlFrequency>=100").reasons,
                ElementsAre("ControlFrequency 125 Hz >= 100"));
    EXPECT_THAT(judged("ControlFrequency>=250").reasons,
                ElementsAre("ControlFrequency 125 Hz not >= 250"));
}

TEST(PropertyWish, ComparesTextsAndTruths) {
    EXPECT_TRUE(judged("Process=MIG").fits);
    EXPECT_FALSE(judged("Process=TIG").fits);
    EXPECT_TRUE(judged("Calibrated=true").fits);
    EXPECT_FALSE(judged("Calibrated=false").fits);
    EXPECT_FALSE(judged("Process>=1").fits);
}

TEST(PropertyWish, IsNotMetByASkillWithoutTheProperty) {
    EXPECT_TRUE(judged("Process").fits);
    EXPECT_FALSE(judged("Accuracy").fits);
    EXPECT_THAT(judged("Accuracy<=0.001").reasons, ElementsAre("no Accuracy"));
}

TEST(PropertyWish, ThatIsNoneIsRefused) {
    for (const auto* text : {"", ">=5", "Rate>=fast", "Rate<="}) {
        const auto wish = parsePropertyWish(text);
        ASSERT_FALSE(wish) << text;
        EXPECT_EQ(wish.error().code, Errc::invalid_argument);
    }
}

}  // namespace
}  // namespace metier::server
