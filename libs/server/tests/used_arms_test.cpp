#include "metier/server/candidate.hpp"

#include <gmock/gmock.h>

namespace metier::server {
namespace {

using ::testing::HasSubstr;

SurveyedSkill skill(const std::string& name, const std::string& controller, std::uint32_t node) {
    SurveyedSkill result;
    result.address.name = name;
    result.address.node = {1, node};
    result.address.above = {{controller, {1, 1000 + node}}, {"Skills", {1, 2000 + node}}};
    return result;
}

SurveyedSkill move(std::optional<double> reach, std::optional<double> payload) {
    auto result = skill("PtpSkill", "Arm", 1);
    result.types = {"PtpMoveSkillType", "MoveSkillType"};
    result.arm = {reach, payload};
    return result;
}

SurveyedSkill composed(const std::string& name, std::vector<client::SkillUse> uses,
                       std::uint32_t node = 1) {
    auto result = skill(name, "Component", node);
    result.uses = std::move(uses);
    return result;
}

client::SkillUse at(const std::string& server, const std::string& name = "PtpSkill",
                    const std::string& controller = "Arm") {
    return {"opc.tcp://" + server, name, controller, {1, 99}};
}

client::SkillUse here(std::uint32_t node) {
    return {"", "", "", {1, node}};
}

SurveyedServer server(const std::string& name, std::vector<SurveyedSkill> skills) {
    return {{"opc.tcp://" + name, name, "test"}, std::move(skills)};
}

/// Figures of the first skill of the first server.
KnownFigures figures(const std::vector<SurveyedServer>& servers) {
    return figuresOf(servers, 0, 0);
}

TEST(UsedArms, AreNotAskedForWhereASkillMovesAnArmByItself) {
    const auto own = figures({server("arm", {move(0.8, std::nullopt)})});
    EXPECT_EQ(own.reach.value, 0.8);
    EXPECT_EQ(own.reach.note, "");
    EXPECT_EQ(own.payload.value, std::nullopt);
}

TEST(UsedArms, TellWhatAComponentCanDo) {
    const auto told = figures(
        {server("component", {composed("Visit", {at("arm")})}), server("arm", {move(0.8, 5.0)})});
    EXPECT_EQ(told.reach.value, 0.8);
    EXPECT_EQ(told.reach.note, "of arm, opc.tcp://arm");
    EXPECT_EQ(told.payload.value, 5.0);
}

TEST(UsedArms, AreFoundThroughComponentsOfComponentsAndSkillsOfTheSameServer) {
    const auto told =
        figures({server("top", {composed("Stack", {at("middle", "Pick", "")})}),
                 server("middle", {composed("Pick", {here(2)}), composed("Visit", {at("arm")}, 2)}),
                 server("arm", {move(0.8, 5.0)})});
    EXPECT_EQ(told.reach.value, 0.8);
    EXPECT_EQ(told.reach.note, "of arm, opc.tcp://arm");
}

TEST(UsedArms, CountByTheWeakestFigureOfEach) {
    const auto told =
        figures({server("component", {composed("Both", {at("far"), at("strong"), at("strong")})}),
                 server("far", {move(1.2, 3.0)}), server("strong", {move(0.8, 12.0)})});
    EXPECT_EQ(told.reach.value, 0.8);
    EXPECT_EQ(told.reach.note, "of strong, opc.tcp://strong, the least of 2 arms");
    EXPECT_EQ(told.payload.value, 3.0);
    EXPECT_EQ(told.payload.note, "of far, opc.tcp://far, the least of 2 arms");
}

TEST(UsedArms, AreNotGrippers) {
    const auto told =
        figures({server("component", {composed("Pick", {at("arm"), at("wsg", "Grasp", "Wsg")})}),
                 server("arm", {move(0.8, 5.0)}), server("wsg", {skill("Grasp", "Wsg", 1)})});
    EXPECT_EQ(told.reach.value, 0.8);
    EXPECT_EQ(told.reach.note, "of arm, opc.tcp://arm");
}

TEST(UsedArms, LeaveUnknownWhatOneOfThemDoesNotTell) {
    const auto told =
        figures({server("component", {composed("Both", {at("a"), at("b")})}),
                 server("a", {move(0.8, 5.0)}), server("b", {move(0.9, std::nullopt)})});
    EXPECT_EQ(told.reach.value, 0.8);
    EXPECT_EQ(told.payload.value, std::nullopt);
    EXPECT_EQ(told.payload.note, "b, opc.tcp://b does not publish it");
    const auto nothing =
        figures({server("component", {composed("One", {at("a")})}), server("a", {move({}, {})})});
    EXPECT_EQ(nothing.reach.value, std::nullopt);
    EXPECT_EQ(nothing.reach.note, "a, opc.tcp://a does not publish it");
}

TEST(UsedArms, LeaveUnknownWhatNobodyWasAskedFor) {
    const auto component = server("component", {composed("Both", {at("a"), at("b")})});
    const auto a = server("a", {move(0.8, 5.0)});
    EXPECT_EQ(figures({component, a}).reach.note, "opc.tcp://b was not asked");
    const SurveyedServer silent{{"opc.tcp://b", "b", "test"}, fail(Errc::timeout, "late")};
    EXPECT_EQ(figures({component, a, silent}).reach.note, "b, opc.tcp://b does not answer");
    const auto other = figures({component, a, server("b", {skill("Grasp", "Wsg", 1)})});
    EXPECT_EQ(other.reach.value, std::nullopt);
    EXPECT_THAT(other.reach.note, HasSubstr("has no PtpSkill"));
}

TEST(UsedArms, AreSoughtWithoutEndInNoCircle) {
    const std::vector circle{
        server("one", {composed("First", {at("two", "Second", ""), here(1)})}),
        server("two", {composed("Second", {at("one", "First", ""), at("arm")})}),
        server("arm", {move(0.8, 5.0)})};
    EXPECT_EQ(figures(circle).reach.value, 0.8);
    EXPECT_EQ(figures({server("self", {composed("Self", {here(1)})})}).reach.value, std::nullopt);
}

TEST(UsedArms, AreFoundByTheSameAddressInAnotherForm) {
    const auto told = figures({server("component", {composed("Visit", {at("localhost:4840/")})}),
                               server("127.0.0.1:4840", {move(0.8, 5.0)})});
    EXPECT_EQ(told.reach.value, 0.8);
}

}  // namespace
}  // namespace metier::server
