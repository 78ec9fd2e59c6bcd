#include <gmock/gmock.h>

#include "lab.hpp"

namespace metier::server::testing {
namespace {

using skill::Value;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::vector<skill::Frame> kPoses{{0.5, 0, 0.4, 3.14159, 0, 3.14159},
                                       {0.4, -0.3, 0.5, 3.14, 0, 1}};

class ArmsOfACell : public Lab {
protected:
    static cell::ServerConfig both(const Server& left, const Server& right) {
        return config("both", cell::SynchronizedServer{
                                  .servers = {{"left", left.url()}, {"right", right.url()}},
                                  .start_delay = 5.0});  // for a busy machine
    }
    static cell::ArmServer movingUr() {
        auto arm = streamedUr();
        arm.skills = {"CartesianPtpMoveSkill", "JointPtpMoveSkill"};
        return arm;
    }
};

TEST_F(ArmsOfACell, AreMovedTogether) {
    const auto left = serve(config("left", iiwa()));
    const auto right = serve(config("right", movingUr()));
    ASSERT_TRUE(left && right);
    const auto server = serve(both(*left, *right));
    ASSERT_TRUE(server);
    const auto client = connect(*server);
    EXPECT_THAT(skillsOf(*client), ElementsAre("SynchronizedMoveSkill"));
    auto skill = open(*client, "SynchronizedMoveSkill");
    const auto& fields = skill.parameters();
    const auto arms = std::find_if(fields.begin(), fields.end(),
                                   [](const auto& field) { return field.name == "Arms"; });
    ASSERT_NE(arms, fields.end());
    EXPECT_EQ(arms->default_value, Value(std::vector<std::string>{"left", "right"}));
    const auto moved = skill.run({{"TargetPoses", Value(kPoses)}}, inAMinute());
    ASSERT_TRUE(moved) << moved.error().message;
    EXPECT_GT(std::get<double>(moved->at("Duration")), 0.0);
}

TEST_F(ArmsOfACell, MustAllHaveMoves) {
    const auto left = serve(config("left", iiwa()));
    const auto right = serve(config("right", streamedUr()));
    ASSERT_TRUE(left && right);
    const auto why = refusal(both(*left, *right));
    EXPECT_EQ(why.code, Errc::not_found);
    EXPECT_THAT(why.message, HasSubstr("CartesianPtpMoveSkillType"));
}

TEST_F(ArmsOfACell, MustAllBeThere) {
    const auto left = serve(config("left", iiwa()));
    ASSERT_TRUE(left);
    auto config = both(*left, *left);
    config.usedServers()[1].url = "opc.tcp://127.0.0.1:1";
    EXPECT_FALSE(refusal(config).message.empty());
}

}  // namespace
}  // namespace metier::server::testing
