// Conversion of servers' data to JSON, and reading of requests.
#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "access.hpp"
#include "arm_json.hpp"
#include "commands.hpp"
#include "live_values.hpp"
#include "metier/base/clock.hpp"
#include "metier/dashboard/cell.hpp"
#include "metier/motion/robot_model.hpp"
#include "metier/records/recorder.hpp"
#include "records_view.hpp"
#include "skill_shown.hpp"
#include "transitions.hpp"

namespace metier::dashboard {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const UtcTime kNoon{std::chrono::seconds(1'800'000'000)};

TEST(LiveValues, TellWhatHasChangedAlone) {
    LiveValues live;
    live.setJoints("ur5", {0.1, 0.2}, kNoon);
    live.setOfArm("ur5", "safety", "Normal");
    EXPECT_EQ(live.changes(kNoon).at("arms").at("ur5").at("safety"), "Normal");
    EXPECT_TRUE(live.changes(kNoon).is_null());
    live.setJoints("ur5", {0.1, 0.2}, kNoon + 33ms);
    EXPECT_TRUE(live.changes(kNoon).is_null()) << "the arm stands still";
    live.setJoints("ur5", {0.1, 0.3}, kNoon + 66ms);
    const auto changes = live.changes(kNoon);
    EXPECT_EQ(changes.at("arms").at("ur5").at("q"), json::array({0.1, 0.3}));
    EXPECT_FALSE(changes.at("arms").at("ur5").contains("safety"));
    EXPECT_EQ(live.all(kNoon).at("arms").at("ur5").at("safety"), "Normal");
}

TEST(LiveValues, TellTheVelocityBetweenTwoSamples) {
    LiveValues live;
    live.setJoints("ur5", {1.0}, kNoon);
    live.setJoints("ur5", {1.1}, kNoon + 100ms);
    EXPECT_EQ(live.changes(kNoon).at("arms").at("ur5").at("v"), json::array({1.0}));
    live.setJoints("ur5", {2.0}, kNoon + 10s);
    EXPECT_EQ(live.changes(kNoon).at("arms").at("ur5").at("v"), json::array({0.0}))
        << "samples of different motions";
}

TEST(LiveValues, TellAWrenchWhoseHalvesComeOneByOne) {
    LiveValues live;
    live.setForce("ur5", {1, 2, 3});
    EXPECT_EQ(live.changes(kNoon).at("arms").at("ur5").at("f"), json::array({1, 2, 3, 0, 0, 0}));
    live.setTorque("ur5", {4, 5, 6});
    EXPECT_EQ(live.changes(kNoon).at("arms").at("ur5").at("f"), json::array({1, 2, 3, 4, 5, 6}));
    live.setForce("ur5", {9, 9});
    EXPECT_TRUE(live.changes(kNoon).is_null()) << "what a server tells may be anything";
}

TEST(LiveValues, TellThatAPartIsGone) {
    LiveValues live;
    live.setPart("cube", {1, 2, 3, 0, 0, 0});
    live.keepParts(json{{"cube", 1}});
    live.changes(kNoon);
    live.keepParts(json::object());
    EXPECT_TRUE(live.changes(kNoon).at("parts").at("cube").is_null());
    EXPECT_FALSE(live.all(kNoon).at("parts").contains("cube"));
}

TEST(BoardTest, SaysWhoseControlItIs) {
    const SystemClock clock;
    Board board({{"name", "test"}}, clock);
    const auto mine = board.openTab("a", 100'000);
    const auto other = board.openTab("b", 100'000);
    mine->take({});
    other->take({});
    board.changeControl("ur5/C", [](ControlState& state) {
        state.server = "ur5";
        state.owner = "metier dashboard, tab a";
        state.held_by = "a";
    });
    EXPECT_THAT(*mine->take({}).at(0), HasSubstr("\"mine\":true"));
    EXPECT_THAT(*other->take({}).at(0), HasSubstr("\"mine\":false"));
}

TEST(BoardTest, ForgetsTheStatesOfAServerThatIsAway) {
    const SystemClock clock;
    Board board({{"name", "test"}}, clock);
    board.addServer("ur5", "ur5", "opc.tcp://127.0.0.1:1");
    ServerShown offer;
    offer.skills = {{{"key", "ur5/C/Move"}}};
    board.setOffer("ur5", offer);
    board.changeSkill("ur5/C/Move", [](SkillState& state) { state.state = "Running"; });
    EXPECT_EQ(board.cell().at("servers").at(0).at("connected"), true);
    board.setDisconnected("ur5", "the connection is lost");
    EXPECT_EQ(board.skill("ur5/C/Move")->state, "Unknown");
    const auto server = board.cell().at("servers").at(0);
    EXPECT_EQ(server.at("error"), "the connection is lost");
    EXPECT_EQ(server.at("skills").size(), 1U) << "what it offered is shown still";
}

TEST(BoardTest, GivesUpATabForWhichTooMuchWaits) {
    const SystemClock clock;
    Board board({{"name", "test"}}, clock);
    const auto tab = board.openTab("a", 2'000);
    EXPECT_FALSE(tab->isClosed());
    for (int i = 0; i < 20; ++i) {
        board.raise({"ur5", 700, std::string(100, 'x')});
    }
    EXPECT_TRUE(tab->isClosed());
    EXPECT_TRUE(tab->take({}).empty());
}

TEST(BoardTest, BeatsWhenNothingChanges) {
    ManualClock clock;
    Board board({{"name", "test"}}, clock);
    const auto tab = board.openTab("a", 100'000);
    tab->take({});
    clock.advance(2s);
    board.tick();
    EXPECT_THAT(*tab->take({}).at(0), HasSubstr("event: beat"));
    clock.advance(100ms);
    board.tick();
    EXPECT_TRUE(tab->take({}).empty());
}

TEST(Transitions, RaiseAnAlarmThatNobodyCalled) {
    const SystemClock clock;
    Board board({{"name", "test"}}, clock);
    const auto told = transitionsTo(board, "ur5/C/Move");
    const auto tab = board.openTab("a", 100'000);
    tab->take({});
    skill::TransitionEvent event;
    event.from = skill::State::running;
    event.to = skill::State::halted;
    event.reason = skill::Reason::owner_lost;
    event.reason_text = "no heartbeat for 1000 ms";
    told(event);
    const auto messages = tab->take({});
    ASSERT_EQ(messages.size(), 2U);
    EXPECT_THAT(*messages[0], HasSubstr("HaltedOwnerLost"));
    EXPECT_THAT(*messages[1], HasSubstr("no heartbeat for 1000 ms"));
}

TEST(Stream, HasNoLineBreakInItsData) {
    const auto message = makeMessage("alarm", {{"text", "a\nb\r\xff"}});
    EXPECT_EQ(*message, "event: alarm\ndata: {\"text\":\"a\\nb\\r\xef\xbf\xbd\"}\n\n");
}

TEST(Parameters, AreReadByTheTypesOfTheSkill) {
    skill::SkillDescription skill;
    skill.name = "Move";
    skill.parameters = {{.name = "Target", .type = skill::ValueType::frame},
                        {.name = "Speed", .type = skill::ValueType::number}};
    const auto values =
        parametersIn(json::parse(R"({"parameters":{"Target":[1,2,3,0,0,0],"Speed":1}})"), skill);
    ASSERT_TRUE(values) << values.error().message;
    EXPECT_EQ(values->at("Target"), skill::Value(skill::Frame{1, 2, 3, 0, 0, 0}));
    EXPECT_EQ(values->at("Speed"), skill::Value(1.0));
    const auto unknown = parametersIn(json::parse(R"({"parameters":{"Sped":1}})"), skill);
    ASSERT_FALSE(unknown);
    EXPECT_EQ(unknown.error().message, "Move has no parameter 'Sped'");
    EXPECT_FALSE(parametersIn(json::parse(R"({"parameters":[1]})"), skill));
    EXPECT_TRUE(parametersIn(json::object(), skill)->empty());
}

TEST(Check, IsThinnedOutFromItsFirstToItsLastRow) {
    skill::CheckReport report;
    report.planned_duration = 10.0;
    for (int row = 0; row <= 1'000; ++row) {
        report.joint_path.push_back({row * 0.001});
    }
    const auto shown = checkJson(report);
    ASSERT_EQ(shown.at("preview").size(), 200U);
    EXPECT_EQ(shown.at("preview").front().at("q"), json::array({0.0}));
    EXPECT_EQ(shown.at("preview").back().at("q"), json::array({1.0}));
    EXPECT_EQ(shown.at("preview").back().at("time"), 10.0);
}

TEST(Check, OfASkillThatMovesNothingHasNoPreview) {
    skill::CheckReport report;
    report.possible = false;
    report.reason = "out of reach: 1.2 m over 0.85 m";
    const auto shown = checkJson(report);
    EXPECT_EQ(shown.at("possible"), false);
    EXPECT_EQ(shown.at("message"), report.reason);
    EXPECT_EQ(shown.at("preview"), json::array());
    EXPECT_EQ(shown.at("notes"), json::array());
}

TEST(Check, ShowsWhatCouldNotBeChecked) {
    skill::CheckReport report;
    report.notes = {"step second: it has no Check"};
    EXPECT_EQ(checkJson(report).at("notes"), json::array({"step second: it has no Check"}));
}

TEST(Values, AreListsHoweverDeepTheyAre) {
    EXPECT_EQ(
        inLists(json::parse(
            R"({"P":{"x":1,"y":2,"z":3,"a":4,"b":5,"c":6},"R":[{"low":0,"high":1}],"S":"t"})")),
        json::parse(R"({"P":[1,2,3,4,5,6],"R":[[0,1]],"S":"t"})"));
    EXPECT_EQ(inLists(json()), json());
}

TEST(Fields, OfJointsAreAsManyAsTheArmHas) {
    skill::Field field;
    field.name = "TargetJointPosition";
    field.type = skill::ValueType::numbers;
    field.unit = skill::kRadian;
    field.range = skill::Range{-6.2, 6.2};
    const auto shown = fieldJson(field, {"ur5", 6, {"flange"}});
    EXPECT_EQ(shown.at("rank"), 6);
    EXPECT_EQ(shown.at("role"), "joints");
    EXPECT_EQ(shown.at("unit"), "rad");
    EXPECT_EQ(shown.at("maximum"), 6.2);
    EXPECT_TRUE(shown.at("default").is_null());
}

TEST(Fields, OfAToolFrameHaveItsNamesToChooseFrom) {
    skill::Field field;
    field.name = "ToolFrame";
    field.type = skill::ValueType::text;
    EXPECT_EQ(fieldJson(field, {"ur5", 6, {"flange", "gripper"}}).at("choices"),
              json::array({"flange", "gripper"}));
}

TEST(CellFrom, TellsWhichServersOthersUse) {
    cell::CellConfig config;
    config.servers.resize(3);
    config.servers[0].name = "ur5";
    config.servers[1].name = "ur5-move";
    config.servers[1].kind = cell::MoveComponent{.robot = "ur5"};
    config.servers[2].name = "both";
    config.servers[2].kind = cell::CompositionServer{
        .files = {}, .servers = {{"ur5-move", ""}, {"opc.tcp://elsewhere:4840", ""}}};
    const auto cell = cellFrom(config);
    EXPECT_THAT(cell.servers.at(0).uses, IsEmpty());
    EXPECT_THAT(cell.servers.at(1).uses, ElementsAre("ur5"));
    EXPECT_THAT(cell.servers.at(2).uses, ElementsAre("ur5-move")) << "and one of no cell";
}

opcua_skill::KinematicsData twoJoints(double length) {
    opcua_skill::KinematicsData data;
    data.joint_frames = {{}, {.x = length}};
    data.joint_axes = {{0, 0, 1}, {0, 0, 1}};
    for (auto* list : {&data.min_joint_position, &data.max_joint_position, &data.max_joint_velocity,
                       &data.max_joint_acceleration, &data.max_joint_jerk}) {
        list->assign(2, 1.0);
    }
    data.tool_frames = {"flange", "pen"};
    return data;
}

TEST(Arms, WithoutAModelHaveNoShape) {
    const auto shown = armJson({"ur5", "ur5", "Arm", std::nullopt}, twoJoints(0.5), {});
    EXPECT_EQ(shown.at("visuals"), json::array());
    EXPECT_TRUE(shown.at("model").is_null());
    EXPECT_EQ(shown.at("base_known"), false);
    EXPECT_EQ(shown.at("joints").at(1).at("origin").at(0), 0.5);
    EXPECT_TRUE(shown.at("tools").at(1).at("frame").is_null());
}

TEST(Cookies, AreNamedByThePortSoThatPagesOfOneHostDoNotLogEachOtherOut) {
    const auto nameAt = [](const std::string& host) {
        httplib::Request request;
        request.headers = {{"Host", host}};
        return sessionCookieName(request);
    };
    EXPECT_EQ(nameAt("127.0.0.1:8080"), "metier_8080");
    EXPECT_EQ(nameAt("[::1]:8081"), "metier_8081");
    EXPECT_EQ(nameAt("[::1]"), "metier");
    EXPECT_EQ(nameAt("cell.example"), "metier");
    EXPECT_EQ(nameAt("127.0.0.1"), "metier");
    EXPECT_EQ(nameAt("1:"), "metier");
    EXPECT_EQ(nameAt("80"), "metier");
    EXPECT_EQ(nameAt(""), "metier");
    EXPECT_EQ(nameAt("a:1;b=2"), "metier");
}

TEST(Cookies, AreFoundAmongOthers) {
    httplib::Request request;
    request.headers = {{"Cookie", "a=1; metier=abc; metier2=x"}};
    EXPECT_EQ(cookie(request, "metier"), "abc");
    EXPECT_EQ(cookie(request, "b"), "");
    EXPECT_EQ(cookie({}, "metier"), "");
}

TEST(RecordsQuery, TakesWhatIsAsked) {
    httplib::Request request;
    request.params = {
        {"skill", "Move"}, {"from", "1800000000.5"}, {"count", "7"}, {"before", "12"}};
    const auto query = recordsQuery(request);
    ASSERT_TRUE(query) << query.error().message;
    EXPECT_EQ(query->first.skill, "Move");
    EXPECT_EQ(query->first.from, kNoon + 500ms);
    EXPECT_EQ(query->second.count, 7U);
    EXPECT_EQ(query->second.before, 12);
}

TEST(RecordsQuery, RefusesWhatIsNoNumber) {
    for (const auto& [name, value] : {std::pair{"from", "nan"},
                                      {"to", "1e300"},
                                      {"count", "1001"},
                                      {"before", "-1"},
                                      {"count", "7x"}}) {
        httplib::Request request;
        request.params = {{name, value}};
        const auto query = recordsQuery(request);
        ASSERT_FALSE(query) << name;
        EXPECT_THAT(query.error().message, HasSubstr(name));
    }
}

/// Records an execution that is over.
void recordMove(const std::string& file, const std::string& id) {
    records::Recorder::Options options;
    options.url = file;
    options.server = "urn:test:iiwa";
    const auto recorder = records::Recorder::create(std::move(options)).value();
    records::ExecutionRow execution;
    execution.id = id;
    execution.parameters = R"({"MaxVelocity":[1.0]})";
    execution.started = kNoon;
    const auto key = recorder->begin(execution);
    recorder->transition(key, {.time = kNoon, .from = "Ready", .to = "Running"});
    recorder->end(key, {.time = kNoon + 1s, .state = "Ready", .reason = "Finished"});
    ASSERT_TRUE(recorder->flush(std::chrono::steady_clock::now() + 60s));
}

TEST(RecordsViewTest, ShowsAStoreThatComesGoesAndComesAgain) {
    const auto folder = std::filesystem::path(::testing::TempDir()) / "records_view";
    std::filesystem::remove_all(folder);
    const auto file = (folder / "records.db").string();
    const SystemClock clock;
    Board board({{"name", "test"}}, clock);
    RecordsView view(file, board);
    const auto ids = [&view] {
        std::vector<std::string> all;
        const auto reply = view.list(httplib::Request());
        for (const auto& record : reply.body.at("records")) {
            all.push_back(record.at("id"));
        }
        return all;
    };
    EXPECT_THAT(ids(), IsEmpty());
    recordMove(file, "first");
    EXPECT_THAT(ids(), ElementsAre("first"));
    recordMove(file, "second");
    EXPECT_THAT(ids(), ElementsAre("second", "first"));
    std::filesystem::remove_all(folder);
    EXPECT_THAT(ids(), IsEmpty());
    recordMove(file, "third");
    EXPECT_THAT(ids(), ElementsAre("third"));
}

TEST(RecordsViewTest, ShowsAllOfOne) {
    const auto folder = std::filesystem::path(::testing::TempDir()) / "records_view_one";
    std::filesystem::remove_all(folder);
    const auto file = (folder / "records.db").string();
    recordMove(file, "move");
    const SystemClock clock;
    Board board({{"name", "test"}}, clock);
    RecordsView view(file, board);
    const auto shown = view.one(1);
    ASSERT_EQ(shown.status, 200);
    const auto& record = shown.body;
    EXPECT_EQ(record.at("id"), "move");
    EXPECT_EQ(record.at("number"), 1);
    EXPECT_EQ(record.at("parameters").at("MaxVelocity").at(0), 1.0);
    EXPECT_TRUE(record.at("check").is_null());
    EXPECT_EQ(record.at("ended").get<double>() - record.at("started").get<double>(), 1.0);
    EXPECT_EQ(record.at("missed_cycles"), 0);
    EXPECT_TRUE(record.at("arm").is_null());
    EXPECT_EQ(record.at("transitions").at(0).at("to"), "Running");
    EXPECT_THAT(record.at("path"), IsEmpty());
    EXPECT_THAT(record.at("children"), IsEmpty());
    EXPECT_EQ(view.one(2).status, 404);
}

}  // namespace
}  // namespace metier::dashboard
