#include <gmock/gmock.h>

#include "lab.hpp"
#include "metier/base/queue.hpp"
#include "metier/records/store.hpp"

// After Eigen, for its macros.
#include <httplib.h>

namespace metier::server::testing {
namespace {

using skill::Value;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::UnorderedElementsAre;

const std::vector<double> kAway{0.2, 0.3, 0.1, -1.2, 0.1, 0.9, 0.1};

class ArmOfACell : public Lab {};

TEST_F(ArmOfACell, OffersTheSkillsOfItsNodeSetAndMovesByThem) {
    const auto server = serve(config("iiwa", iiwa()));
    ASSERT_TRUE(server);
    const auto client = connect(*server);
    EXPECT_THAT(skillsOf(*client),
                UnorderedElementsAre("CartesianPtpMoveSkill", "CartesianLinearMoveSkill",
                                     "JointPtpMoveSkill", "JointLinearMoveSkill"));
    auto move = open(*client, "JointPtpMoveSkill");
    const auto moved = move.run({{"TargetJointPosition", Value(kAway)}}, inAMinute());
    ASSERT_TRUE(moved) << moved.error().message;
    EXPECT_THAT(*moved, Contains(::testing::Key("Duration")));
}

TEST_F(ArmOfACell, HasObjectsOfItsOwnWithoutANodeSet) {
    auto arm = streamedUr();
    arm.skills = {"PositionStreamSkill", "JointPtpMoveSkill"};
    const auto server = serve(config("ur5", arm));
    ASSERT_TRUE(server);
    const auto client = connect(*server);
    EXPECT_THAT(skillsOf(*client),
                UnorderedElementsAre("PositionStreamSkill", "JointPtpMoveSkill"));
    const auto move = open(*client, "JointPtpMoveSkill");
    EXPECT_EQ(move.parameters().front().name, "TargetJointPosition");
    EXPECT_EQ(move.address().above.front().name, "DeviceSet");
}

TEST_F(ArmOfACell, TakesTheToolsOfTheCellBesidesThoseOfItsModel) {
    auto arm = iiwa();
    arm.tools = {{.name = "pen", .frame = {0, 0, 0.1, 0, 0, 0}, .mass = 0.2}};
    const auto server = serve(config("iiwa", arm));
    ASSERT_TRUE(server);
    const auto client = connect(*server);
    auto move = open(*client, "CartesianPtpMoveSkill");
    EXPECT_TRUE(move.set("ToolFrame", Value(std::string("pen"))));
    const auto refused = move.set("ToolFrame", Value(std::string("brush")));
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr("brush"));
}

TEST_F(ArmOfACell, IsRefusedWithoutItsModel) {
    auto arm = iiwa();
    arm.model = folder_ / "none.toml";
    EXPECT_THAT(refusal(config("iiwa", arm)).message, HasSubstr("none.toml"));
}

TEST_F(ArmOfACell, IsRefusedWithAnotherKindOfDevice) {
    auto arm = iiwa();
    arm.driver.type = "gripper";
    const auto why = refusal(config("iiwa", arm));
    EXPECT_EQ(why.code, Errc::invalid_argument);
    EXPECT_EQ(why.message, "iiwa: the driver \"gripper\" is not one of an arm");
    arm = iiwa();
    arm.force_torque_sensor = cell::DriverChoice{"gripper", "", {}};
    EXPECT_EQ(refusal(config("iiwa", arm)).message,
              "iiwa: the driver \"gripper\" is not one of a force-torque sensor");
}

TEST_F(ArmOfACell, IsRefusedWithASkillThatNoArmHas) {
    auto arm = streamedUr();
    arm.skills = {"PositionStreamSkill", "DanceSkill"};
    const auto why = refusal(config("ur5", arm));
    EXPECT_EQ(why.code, Errc::not_supported);
    EXPECT_EQ(why.message, "no skill 'DanceSkill' for this device");
}

TEST_F(ArmOfACell, IsRefusedIfItsNodeSetHasSkillsThatNobodyWants) {
    auto arm = iiwa();
    arm.skills = {"JointPtpMoveSkill"};
    EXPECT_THAT(
        refusal(config("iiwa", arm)).message,
        AllOf(HasSubstr("skills = [JointPtpMoveSkill]"), HasSubstr("the NodeSet also has")));
}

TEST_F(ArmOfACell, MovesUntilAContactOnlyWithASensor) {
    auto arm = streamedUr();
    arm.skills = {"CartesianLinearForceMoveSkill"};
    EXPECT_EQ(refusal(config("ur5", arm)).code, Errc::not_supported);
    arm.force_torque_sensor = cell::DriverChoice{"sensor", "", {}};
    const auto server = serve(config("ur5", arm));
    ASSERT_TRUE(server);
    EXPECT_THAT(skillsOf(*connect(*server)), ElementsAre("CartesianLinearForceMoveSkill"));
}

TEST_F(ArmOfACell, OffersSkillsThatFilesMakeOfItsOwn) {
    auto arm = iiwa();
    arm.compositions = {write("swing.toml", R"(name = "SwingSkill"
[parameters.Target]
type = "numbers"
unit = "rad"
length = 7
[uses.arm]
type = "JointPtpMoveSkillType"
[[step]]
name = "swing"
run = "arm"
with.TargetJointPosition = { from = "Target" }
)")};
    const auto server = serve(config("iiwa", arm));
    ASSERT_TRUE(server);
    const auto client = connect(*server);
    auto swing = open(*client, "SwingSkill");
    const auto moved = swing.run({{"Target", Value(kAway)}}, inAMinute());
    EXPECT_TRUE(moved) << moved.error().message;
}

TEST_F(ArmOfACell, SaysWhatIsWrongInEachFileOfItsOwnSkills) {
    auto arm = iiwa();
    arm.compositions = {write("wrong.toml", R"(name = "WrongSkill"
[uses.far]
type = "JointPtpMoveSkillType"
server = "elsewhere"
[uses.strong]
type = "JointLinearMoveSkillType"
reach = 1.0
[uses.none]
type = "GraspGripperSkillType"
[[step]]
name = "one"
run = "far"
[[step]]
name = "two"
run = "strong"
[[step]]
name = "three"
run = "none"
)")};
    const auto why = refusal(config("iiwa", arm)).message;
    EXPECT_THAT(why, HasSubstr("wrong.toml:2: uses.far: server \"elsewhere\" is not this one"));
    EXPECT_THAT(why, HasSubstr("uses.strong: controller, reach and payload choose among skills"));
    EXPECT_THAT(why, HasSubstr("uses.none: this server has no skill of type "
                               "GraspGripperSkillType; it has: "));
}

TEST_F(ArmOfACell, RecordsWhatItDoesWhereTheCellSays) {
    auto recorded = config("iiwa", iiwa());
    recorded.records.url = (folder_ / "records.db").string();
    {
        const auto server = serve(recorded);
        ASSERT_TRUE(server);
        const auto client = connect(*server);
        auto move = open(*client, "JointPtpMoveSkill");
        ASSERT_TRUE(move.run({{"TargetJointPosition", Value(kAway)}}, inAMinute()));
    }
    const auto store = records::Store::open(recorded.records.url);
    ASSERT_TRUE(store) << store.error().message;
    const auto listing = (*store)->list({}, {.before = 0, .count = 10});
    ASSERT_TRUE(listing && listing->executions.size() == 1U);
    const auto& execution = listing->executions.front();
    EXPECT_EQ(execution.server_name, "iiwa");
    EXPECT_EQ(execution.skill, "JointPtpMoveSkill");
    EXPECT_EQ(execution.state, "Ready");
    EXPECT_TRUE(execution.isOver());
}

TEST_F(ArmOfACell, KnowsItsExecutionsAfterARestartByItsStateFolder) {
    auto kept = config("iiwa", iiwa());
    kept.state_folder = folder_;
    const skill::StartRequest once{"once", {{"TargetJointPosition", Value(kAway)}}};
    {
        const auto server = serve(kept);
        ASSERT_TRUE(server);
        const auto client = connect(*server);
        auto move = open(*client, "JointPtpMoveSkill");
        ASSERT_TRUE(move.runWith(once, inAMinute()));
    }
    EXPECT_TRUE(std::filesystem::exists(folder_ / "iiwa-127.0.0.1-0.executions"));
    EXPECT_TRUE(std::filesystem::exists(folder_ / "audit" / "iiwa-127.0.0.1-0.log"));
    const auto again = serve(kept);
    ASSERT_TRUE(again);
    const auto client = connect(*again);
    auto move = open(*client, "JointPtpMoveSkill");
    EXPECT_FALSE(move.startWith(once)) << "it ran before";
}

TEST_F(ArmOfACell, HasFiguresByHttpIfItsCellSaysWhere) {
    auto measured = config("iiwa", iiwa());
    const auto address = "127.68." + std::to_string((getpid() >> 8) % 256) + "." +
                         std::to_string(getpid() % 254 + 1);
    measured.metrics = cell::HttpAddress{address, 9465};
    const auto server = serve(measured);
    ASSERT_TRUE(server);
    httplib::Client http(address, 9465);
    http.set_read_timeout(30);
    const auto page = http.Get("/metrics");
    ASSERT_TRUE(page);
    EXPECT_THAT(page->body, HasSubstr("metier_device_state{device=\"iiwa\",state=\"normal\"} 1"));
    EXPECT_THAT(page->body,
                HasSubstr("metier_skill_state{skill=\"JointPtpMoveSkill\",state=\"Ready\"} 1"));
}

TEST_F(ArmOfACell, IsRefusedAtAPortThatAnotherServerHas) {
    const auto first = serve(config("iiwa", iiwa()));
    ASSERT_TRUE(first);
    auto second = config("other", streamedUr());
    second.port =
        static_cast<std::uint16_t>(std::stoi(first->url().substr(first->url().rfind(':') + 1)));
    EXPECT_FALSE(refusal(second).message.empty());
}

TEST_F(ArmOfACell, BrakesBeforeItsServerEnds) {
    auto server = serve(config("iiwa", iiwa()));
    ASSERT_TRUE(server);
    const auto client = connect(*server);
    Queue<skill::TransitionEvent> events(10);  // outlives what reports to it
    auto move = open(*client, "JointPtpMoveSkill");
    move.onTransition([&events](const skill::TransitionEvent& event) {
        static_cast<void>(events.tryPush(event));
    });
    // Slow enough that it is under way still, however long this thread is held up.
    ASSERT_TRUE(move.startWith({"",
                                {{"TargetJointPosition", Value(std::vector<double>(7, 1.5))},
                                 {"SpeedOverride", Value(0.05)}}}));
    server.reset();
    const auto running = events.popUntil(inAMinute());
    ASSERT_TRUE(running);
    EXPECT_EQ(running->to, skill::State::running);
    const auto halted = events.popUntil(inAMinute());
    ASSERT_TRUE(halted);
    EXPECT_EQ(halted->to, skill::State::halted);
    EXPECT_THAT(halted->reason_text, HasSubstr("the server is ended"));
}

}  // namespace
}  // namespace metier::server::testing
