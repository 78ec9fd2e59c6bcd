// Pick and place by composition: an arm and a gripper of two servers under a component, and a robot
// that has the same skill itself. Parts that are missing, slip or are too wide.
#include <gmock/gmock.h>

#include <future>
#include <nlohmann/json.hpp>
#include <numbers>

#include "metier/client/control_handle.hpp"
#include "metier_program.hpp"
#include "running_cell.hpp"

namespace metier::system_tests {
namespace {

using namespace std::chrono_literals;
using skill::Frame;
using skill::State;
using skill::Value;
using skill::ValueMap;
using ::testing::Contains;
using ::testing::HasSubstr;

constexpr const char* kSkill = "PickPlaceSkill";

/// The tool looks down. \param turn about z, so that no axis comes to its limit [rad]
Frame above(double x, double y, double turn = 0.0) {
    return {x, y, 0.015, std::numbers::pi, 0, turn};
}

ValueMap partFrom(const Frame& pick, double width = 0.0) {
    return {{"PickPose", pick},
            {"PlacePose", above(pick.x, pick.y - 0.1)},
            {"ApproachDistance", 0.05},
            {"PartWidth", width}};
}

class PickingCell : public ::testing::Test {
protected:
    double coordinate(const char* part, int axis) const {
        return cell_.state("world").at("parts").at(part).at("pose").at(axis).get<double>();
    }
    bool armStands() const { return cell_.state("iiwa").at("standing_for").get<double>() > 0.0; }

    opcua::Answer<ValueMap> pick(const ValueMap& parameters) {
        return skill_.runWith({"", parameters}, inAMinute());
    }
    /// After a failure: Halted, the arm stands; Reset, and the next part succeeds.
    void expectTheWayBack() {
        EXPECT_EQ(*skill_.state(), State::halted);
        EXPECT_TRUE(armStands());
        ASSERT_TRUE(skill_.reset());
        const auto placed = pick(partFrom(above(0.45, 0.0)));
        ASSERT_TRUE(placed) << placed.error().message;
        EXPECT_NEAR(coordinate("cube", 1), -0.1, 1e-3);
    }

    RunningCell cell_{deviceCell("pick_place")};
    std::unique_ptr<opcua::Client> client_ = connectTo(cell_.url("component"));
    client::SkillHandle skill_ = openSkill(*client_, kSkill);
};

TEST_F(PickingCell, IsFoundByItsTaskWithWhatItsArmCanDo) {
    std::vector<std::string> arguments{"find",      "pick-place", "--reach", "0.6",
                                       "--payload", "1",          "--json"};
    for (const auto& [name, url] : cell_.urls()) {
        arguments.insert(arguments.end(), {"--at", url});
    }
    const auto found = runMetier(arguments);
    EXPECT_EQ(found.status, 0);
    const auto json = nlohmann::json::parse(found.output);
    std::map<std::string, nlohmann::json> by_url;
    for (const auto& candidate : json.at("candidates")) {
        by_url[candidate.at("url")] = candidate;
    }
    ASSERT_EQ(by_url.size(), 2U) << found.output;
    const auto& composed = by_url[cell_.url("component")];
    EXPECT_TRUE(composed.at("fits").get<bool>());
    EXPECT_EQ(composed.at("term"), "urn:metier:dictionary:pick-and-place");
    EXPECT_EQ(composed.at("payload"), 7.0);
    EXPECT_EQ(composed.at("reach_note"), "of " + cell_.url("arm"));
    const auto& own = by_url[cell_.url("edo")];
    EXPECT_FALSE(own.at("fits").get<bool>());
    EXPECT_THAT(own.at("reasons"), Contains("payload unknown"));
}

TEST_F(PickingCell, PlacesAPartAndTellsWhatItDid) {
    EXPECT_EQ(skill_.address().type_name, "PickPlaceSkillType");
    const auto placed = pick(partFrom(above(0.45, 0.0), 0.03));
    ASSERT_TRUE(placed) << placed.error().message;
    EXPECT_EQ(placed->at("PartHeld"), Value(true));
    EXPECT_NEAR(std::get<double>(placed->at("Width")), 0.03, 2e-3);
    const auto steps = std::get<std::vector<std::string>>(placed->at("Steps"));
    EXPECT_EQ(steps.front(), "open");
    EXPECT_THAT(steps, Contains("carry/move/above_place"));
    EXPECT_EQ(std::get<std::vector<double>>(placed->at("StepDurations")).size(), steps.size());
    EXPECT_NEAR(coordinate("cube", 0), 0.45, 1e-3);
    EXPECT_NEAR(coordinate("cube", 1), -0.1, 1e-3);
    EXPECT_NEAR(coordinate("cube", 2), 0.015, 1e-4);
    const auto gripper = connectTo(cell_.url("gripper"));
    EXPECT_EQ(*openSkill(*gripper, "HoldGripperSkill").state(), State::ready)
        << "the end of the background step is nobody's fault";
}

TEST_F(PickingCell, SaysThatAPartIsMissingAndLeavesThePlace) {
    const auto missed = pick(partFrom(above(0.45, 0.1)));
    ASSERT_FALSE(missed);
    EXPECT_THAT(missed.error().message, HasSubstr("no part found"));
    EXPECT_THAT(missed.error().message, HasSubstr("take/leave/no_part"));
    expectTheWayBack();
}

TEST_F(PickingCell, SaysThatAPartIsTooWideAndLeavesIt) {
    const auto wide = pick(partFrom(above(0.45, 0.2), 0.03));
    ASSERT_FALSE(wide);
    EXPECT_THAT(wide.error().message, HasSubstr("blocked at 60.0 mm"));
    EXPECT_NEAR(coordinate("block", 1), 0.2, 1e-3) << "it was left where it was";
    expectTheWayBack();
}

TEST_F(PickingCell, StopsTheArmIfThePartSlipsOnTheWay) {
    auto line = partFrom(above(0.45, 0.0));
    ASSERT_TRUE(skill_.startWith({"slipping", line}));
    const auto deadline = inAMinute();
    while (coordinate("cube", 2) < 0.02) {
        ASSERT_LT(std::chrono::steady_clock::now(), deadline) << "the part is not lifted";
    }
    cell_.inject("world", "drop", "wsg");
    const auto end = skill_.awaitEnd(inAMinute()).value();
    EXPECT_EQ(end.to, State::halted);
    EXPECT_EQ(end.reason, skill::Reason::error);
    EXPECT_THAT(end.reason_text, HasSubstr("carry/watch"));
    EXPECT_THAT(end.reason_text, HasSubstr("holds no part"));
    EXPECT_NEAR(coordinate("cube", 2), 0.015, 1e-4) << "it lies on the table";
    cell_.inject("world", "place", "cube,0.45,0,0.015");
    expectTheWayBack();
}

TEST_F(PickingCell, IsOfferedByARobotItselfToTheSameClientAlsoUnderALease) {
    const auto edo = connectTo(cell_.url("edo"));
    auto own = openSkill(*edo, kSkill);
    EXPECT_EQ(own.address().type_name, "PickPlaceSkillType");
    const auto control =
        client::ControlHandle::acquire(*edo, own.address().controller()->node, {.lease = 30s});
    ASSERT_TRUE(control) << control.error().message;
    auto parameters = partFrom(above(0.42, 0.0, 0.2));
    parameters["PlacePose"] = above(0.42, 0.08, 0.2);
    const auto placed = own.runWith({"", parameters}, inAMinute());
    ASSERT_TRUE(placed) << placed.error().message;
    EXPECT_NEAR(coordinate("edo-cube", 1), 0.08, 2e-3);
}

TEST_F(PickingCell, IsLeftAloneByTheCommandOnceSomebodyElseHaltsIt) {
    // The command once reset the skill and moved the arm again, 70 ms after the Halt.
    auto command = std::async(std::launch::async, [this] {
        return runMetier({"pick-place", cell_.url("component"), "--parts", "3", "--pick",
                          "0.45,0,0.015,3.14159,0,0", "--place", "0.45,-0.1,0.015,3.14159,0,0"});
    });
    const auto deadline = inAMinute();
    while (*skill_.state() != State::running) {
        ASSERT_LT(std::chrono::steady_clock::now(), deadline) << "the command begins nothing";
    }
    ASSERT_TRUE(skill_.halt());
    const auto ended = command.get();
    EXPECT_EQ(ended.status, 1);
    EXPECT_THAT(ended.output, HasSubstr("part 1: PickPlaceSkill was halted (ByClient)"));
    EXPECT_THAT(ended.output, ::testing::Not(HasSubstr("part 2:")));
    EXPECT_EQ(*skill_.state(), State::halted);
}

TEST(PickPlaceCommand, SaysWhatIsWrong) {
    const auto wrong = runMetier({"pick-place", "opc.tcp://127.0.0.1:1", "--pick", "1,2,3"});
    EXPECT_EQ(wrong.status, 2);
    EXPECT_THAT(wrong.output, HasSubstr("--pick"));
    const auto nobody = runMetier({"pick-place", "opc.tcp://127.0.0.1:1"});
    EXPECT_EQ(nobody.status, 1);
}

}  // namespace
}  // namespace metier::system_tests
