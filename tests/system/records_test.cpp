// Records of executions by any client, and the records that remain after a crash.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <csignal>
#include <fstream>

#include "metier/opcua_skill/values.hpp"
#include "recorded_server.hpp"
#include "server_events.hpp"
#include "small_disk.hpp"
#include "watched_skill.hpp"

namespace metier::system_tests {
namespace {

using records::ExecutionRow;
using skill::State;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

constexpr const char* kMove = "JointPtpMoveSkill";

std::filesystem::path emptyFolder() {
    const auto* name = ::testing::UnitTest::GetInstance()->current_test_info()->name();
    auto folder = std::filesystem::path(::testing::TempDir()) / "records_system_test" / name;
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder);
    return folder;
}

std::vector<std::string> waysOf(const RecordFile& file, const ExecutionRow& record) {
    std::vector<std::string> ways;
    const auto transitions = file.open()->transitions(record.number);
    EXPECT_TRUE(transitions);
    for (const auto& one : *transitions) {
        if (one.from != one.to) {
            ways.push_back(one.from + ">" + one.to);
        }
    }
    return ways;
}

/// An iiwa without controller and wire, with move skills of its own.
class RecordedArm : public ::testing::Test {
protected:
    explicit RecordedArm(int disk = 0)
        : disk_(disk == 0 ? nullptr : SmallDisk::mount(folder_, disk)) {}

    skill::ValueMap move(double by, double speed = 1.0) const {
        auto target = home_;
        target.front() += by;
        return {{"TargetJointPosition", target}, {"SpeedOverride", speed}};
    }
    /// The path of a record begins and ends there [rad, axis 1], without a gap on the way.
    void expectPath(const ExecutionRow& record, double from, double to) const {
        const auto path = file_.open()->path(record.number);
        ASSERT_TRUE(path);
        ASSERT_GE(path->size(), 3U);
        EXPECT_NEAR(path->front().actual[0], from, 1e-3);
        EXPECT_NEAR(path->back().actual[0], to, 1e-3);
        EXPECT_EQ(path->front().actual.size(), 7U);
        EXPECT_EQ(path->front().commanded.size(), 7U);
        for (std::size_t i = 1; i < path->size(); ++i) {
            EXPECT_GE((*path)[i].time, (*path)[i - 1].time);
        }
    }

    const std::filesystem::path folder_ = emptyFolder();
    std::unique_ptr<SmallDisk> disk_;
    const RecordFile file_{folder_};
    std::optional<ServerProcess> server_{std::in_place, "iiwa", file_.serving()};
    std::optional<Watched> arm_{std::in_place, server_->url(), kMove};
    std::vector<double> home_ = jointPosition(arm_->client(), **arm_);
};

TEST_F(RecordedArm, IsRecordedWhenTheCommandMovesIt) {
    auto target = home_;
    target.front() += 0.3;
    const auto run = runMetier({"run", server_->url(), kMove, "--set",
                                fmt::format("TargetJointPosition={}", fmt::join(target, ","))});
    ASSERT_EQ(run.status, 0) << run.output;
    const auto record = file_.awaitEnd(kMove);
    EXPECT_EQ(record.server_name, "iiwa");
    EXPECT_THAT(record.server, HasSubstr(":metier:iiwa:"));
    EXPECT_EQ(record.client_name, "metier command");
    EXPECT_THAT(record.controller, Not(""));
    EXPECT_THAT(record.device, Not(""));
    EXPECT_THAT(record.session, StartsWith("ns="));
    EXPECT_EQ(record.parent, "");
    EXPECT_EQ(record.state, "Ready");
    EXPECT_EQ(record.reason, "Finished");
    EXPECT_THAT(record.parameters, HasSubstr("\"TargetJointPosition\":[0.3"));
    EXPECT_THAT(record.result, HasSubstr("\"Duration\":"));
    EXPECT_THAT(waysOf(file_, record), ElementsAre("Ready>Running", "Running>Ready"));
    expectPath(record, home_.front(), target.front());
}

TEST_F(RecordedArm, IsRecordedWhenAClientOfPart10MovesIt) {
    auto& client = arm_->client();
    const auto node = (*arm_)->address().node;
    const auto start = client.translate(node, {{0, "Start"}});
    ASSERT_TRUE(start);
    ASSERT_TRUE((*arm_)->set("TargetJointPosition", move(0.2).at("TargetJointPosition")));
    ASSERT_TRUE(client.call(node, *start));
    arm_->awaitEvent(State::ready);
    const auto record = file_.awaitEnd(kMove);
    EXPECT_EQ(record.reason, "Finished");
    EXPECT_EQ(record.check, "");
    expectPath(record, home_.front(), home_.front() + 0.2);
}

TEST_F(RecordedArm, TellsWhatCheckSaidBefore) {
    ASSERT_TRUE((*arm_)->check(move(0.2)));
    ASSERT_TRUE((*arm_)->startWith({.execution_id = "checked", .parameters = move(0.2)}));
    const auto record = file_.awaitEnd(kMove);
    EXPECT_EQ(record.id, "checked");
    EXPECT_THAT(record.check, AllOf(HasSubstr("\"possible\":true"),
                                    HasSubstr("\"planned_duration\":"), Not(HasSubstr(":0.0}"))));
}

TEST_F(RecordedArm, IsRecordedWhenItIsSuspendedResumedAndHalted) {
    ASSERT_TRUE((*arm_)->startWith({.execution_id = "long", .parameters = move(1.0, 0.1)}));
    awaitMotion(arm_->client(), **arm_, home_);
    ASSERT_TRUE((*arm_)->suspend());
    arm_->awaitEvent(State::suspended);
    const auto suspended =
        file_.await({.skill = kMove}, [](const auto& one) { return one.state == "Suspended"; });
    EXPECT_FALSE(suspended.isOver());
    ASSERT_TRUE((*arm_)->resume());
    arm_->awaitEvent(State::running);
    ASSERT_TRUE((*arm_)->halt());
    const auto halted = arm_->awaitEvent(State::halted);
    const auto record = file_.awaitEnd(kMove);
    EXPECT_EQ(record.id, "long");
    EXPECT_EQ(record.state, "Halted");
    EXPECT_EQ(record.reason, "ByClient");
    EXPECT_EQ(std::chrono::floor<std::chrono::milliseconds>(record.ended),
              std::chrono::floor<std::chrono::milliseconds>(halted.time));
    EXPECT_THAT(waysOf(file_, record), ElementsAre("Ready>Running", "Running>Suspended",
                                                   "Suspended>Running", "Running>Halted"));
    expectPath(record, home_.front(), jointPosition(arm_->client(), **arm_).front());
}

TEST_F(RecordedArm, HasNoRecordOfWhatIsRefused) {
    EXPECT_FALSE((*arm_)->startWith({.execution_id = "wrong", .parameters = move(100.0)}));
    ASSERT_TRUE((*arm_)->startWith({.execution_id = "right", .parameters = move(0.1)}));
    EXPECT_EQ(file_.awaitEnd(kMove).id, "right");
    const auto listed = file_.open()->list({}, {});
    ASSERT_TRUE(listed);
    EXPECT_EQ(listed->executions.size(), 1U);
}

TEST_F(RecordedArm, ShowsTheLastExecutionsToThoseWhoBrowse) {
    auto& client = arm_->client();
    ASSERT_TRUE((*arm_)->startWith({.execution_id = "one", .parameters = move(0.1)}));
    arm_->awaitEvent(State::ready);
    ASSERT_TRUE((*arm_)->startWith(
        {.execution_id = "two", .parameters = move(0.2), .parent = {"above", "urn:elsewhere"}}));
    arm_->awaitEvent(State::ready);
    const auto metier = client.namespaceIndex("urn:metier:skills");
    ASSERT_TRUE(metier);
    const auto read = [&](const std::string& record, const std::string& property) {
        const auto node = client.translate(
            (*arm_)->address().node,
            {{*metier, "ExecutionRecords"}, {*metier, record}, {*metier, property}});
        EXPECT_TRUE(node) << record << "/" << property;
        const auto value = client.read(*node);
        return value ? value->toString() : value.error().status.name();
    };
    EXPECT_THAT(read("Latest", "ExecutionId"), HasSubstr("two"));
    EXPECT_THAT(read("Latest", "ParentExecution"), HasSubstr("above"));
    EXPECT_THAT(read("Latest", "ParentServer"), HasSubstr("urn:elsewhere"));
    EXPECT_THAT(read("Latest", "SkillName"), HasSubstr(kMove));
    EXPECT_THAT(read("Latest", "EndState"), HasSubstr("12"));
    EXPECT_THAT(read("Latest", "Parameters"), HasSubstr("TargetJointPosition"));
    EXPECT_THAT(read("Latest", "Result"), HasSubstr("Duration"));
    EXPECT_THAT(read("Latest-1", "ExecutionId"), HasSubstr("one"));
    EXPECT_THAT(read("Latest-1", "ParentExecution"), Not(HasSubstr("above")));
    EXPECT_EQ(read("Latest-9", "ExecutionId"), "BadNoData");
}

TEST_F(RecordedArm, LosesAtMostTheLastSecondToACrashAndIsClosedAtTheNextStart) {
    const auto port = lastingPort();
    arm_.reset();
    server_.emplace("iiwa",
                    std::vector<std::string>{"--port", port, "--records", file_.path().string()});
    arm_.emplace(server_->url(), kMove);
    ASSERT_TRUE((*arm_)->startWith({.execution_id = "over", .parameters = move(0.1)}));
    arm_->awaitEvent(State::ready);
    ASSERT_TRUE((*arm_)->startWith({.execution_id = "killed", .parameters = move(1.0, 0.02)}));
    double lag = 0;  // largest delay of the file behind the arm on this machine [s]
    file_.await({.skill = kMove}, [this, &lag](const auto& one) {
        const auto path = file_.open()->path(one.number);
        if (one.id != "killed" || !path || path->empty()) {
            return false;
        }
        const std::chrono::duration<double> age = std::chrono::system_clock::now() - one.started;
        lag = std::max(lag, age.count() - path->back().time);
        return path->back().time > 2.0;
    });
    const auto killed_at = std::chrono::system_clock::now();
    server_->kill();
    arm_.reset();
    server_.emplace("iiwa",
                    std::vector<std::string>{"--port", port, "--records", file_.path().string()});
    const auto record = file_.await(
        {.skill = kMove}, [](const auto& one) { return one.id == "killed" && one.isOver(); });
    EXPECT_EQ(record.state, records::kLost);
    EXPECT_EQ(record.reason, records::kServerLost);
    const auto path = file_.open()->path(record.number);
    ASSERT_TRUE(path);
    ASSERT_FALSE(path->empty());
    const std::chrono::duration<double> age = killed_at - record.started;
    EXPECT_LT(age.count() - path->back().time, std::max(1.0, 2.0 * lag))
        << "0.3 s on a machine that does little else";
    EXPECT_EQ(
        file_.await({.skill = kMove}, [](const auto& one) { return one.id == "over"; }).reason,
        "Finished");
}

class RecordedArmOnASmallDisk : public RecordedArm {
protected:
    RecordedArmOnASmallDisk() : RecordedArm(1024) {}
};

TEST_F(RecordedArmOnASmallDisk, MovesOnAndHaltsWhileTheDiskIsFullAndSaysSo) {
    if (disk_ == nullptr) {
        GTEST_SKIP() << kNoSmallDisk;
    }
    ServerEvents alarms(arm_->client(), opcua::ids::kSystemEventType);
    ASSERT_TRUE((*arm_)->startWith({.execution_id = "before", .parameters = move(0.1)}));
    arm_->awaitEvent(State::ready);
    static_cast<void>(file_.awaitEnd(kMove));
    ASSERT_TRUE((*arm_)->startWith({.execution_id = "full", .parameters = move(1.0, 0.2)}));
    arm_->awaitEvent(State::running);
    disk_->fill();
    EXPECT_THAT(alarms.next("record"), HasSubstr("disk is full"));
    arm_->awaitEvent(State::ready);
    EXPECT_NEAR(jointPosition(arm_->client(), **arm_).front(), home_.front() + 1.0, 1e-3);
    const auto second_home = jointPosition(arm_->client(), **arm_);
    ASSERT_TRUE((*arm_)->startWith({.execution_id = "halted", .parameters = move(0.0, 0.1)}));
    awaitMotion(arm_->client(), **arm_, second_home);
    ASSERT_TRUE((*arm_)->halt());
    arm_->awaitEvent(State::halted);
    disk_->makeRoom();
    EXPECT_THAT(alarms.next("recorded again"), Not(""));
    const auto ended = [this](const std::string& id) {
        return file_.await({.skill = kMove},
                           [&](const auto& one) { return one.id == id && one.isOver(); });
    };
    EXPECT_EQ(ended("halted").state, "Halted");
    EXPECT_EQ(ended("full").reason, "Finished");
}

std::filesystem::path composedCell() {
    return std::filesystem::path(METIER_SOURCE_DIR) / "tests" / "system" / "composed.toml";
}

class RecordedComposition : public ::testing::Test {
protected:
    ServerProcess serve(const std::string& name, const std::vector<std::string>& more = {}) {
        return ServerProcess(name, file_.serving(more), composedCell());
    }

    const RecordFile file_{emptyFolder()};
    ServerProcess arm_ = serve("iiwa");
    ServerProcess swing_ = serve("swing", {"--use", "iiwa=" + arm_.url()});
    ServerProcess wave_ = serve("wave", {"--use", "swing=" + swing_.url()});
};

TEST_F(RecordedComposition, HasItsChildrenOnOtherServersAndTheyHaveTheirParents) {
    Watched wave(wave_.url(), "WaveSkill");
    Watched arm(arm_.url(), kMove);
    const auto home = jointPosition(arm.client(), *arm);
    auto away = home;
    away.front() += 0.2;
    const auto result =
        wave->runWith({"wave", {{"Home", home}, {"Away", away}, {"Speed", 1.0}}}, inAMinute());
    ASSERT_TRUE(result) << result.error().message;
    const auto top = file_.awaitEnd("WaveSkill");
    EXPECT_EQ(top.parent, "");
    // Each server writes its records by itself.
    file_.awaitEnds("ThereAndBackSkill", 2);
    file_.awaitEnds("SwingSkill", 4);
    file_.awaitEnds(kMove, 4);
    const auto store = file_.open();
    // WaveSkill runs ThereAndBackSkill of the same server, which runs SwingSkill of another server,
    // which runs the move of a third.
    std::vector<ExecutionRow> level{top};
    for (const auto* skill : {"ThereAndBackSkill", "SwingSkill", kMove}) {
        std::vector<ExecutionRow> below;
        for (const auto& parent : level) {
            const auto children = store->children(parent.number);
            ASSERT_TRUE(children);
            ASSERT_FALSE(children->empty()) << skill;
            for (const auto& child : *children) {
                EXPECT_EQ(child.skill, skill);
                EXPECT_EQ(child.parent, parent.id);
                EXPECT_GE(child.started, parent.started);
                EXPECT_LE(child.ended, parent.ended);
                below.push_back(child);
            }
        }
        level = below;
    }
    EXPECT_EQ(level.size(), 4U);
    EXPECT_EQ(level.front().server_name, "iiwa");
    EXPECT_THAT(level.front().parent_server, HasSubstr(":metier:swing:"));
}

TEST_F(RecordedComposition, SaysWhatItStartedWhereItsRecordIsAloneInAFile) {
    Watched swing(swing_.url(), "SwingSkill");
    Watched arm(arm_.url(), kMove);
    auto target = jointPosition(arm.client(), *arm);
    target.front() += 0.1;
    ASSERT_TRUE(swing->runWith({"swing", {{"Target", target}, {"Speed", 1.0}}}, inAMinute()));
    const auto record = file_.awaitEnd("SwingSkill");
    const auto move = file_.awaitEnd(kMove);
    const auto told = file_.open()->intermediates(record.number);
    ASSERT_TRUE(told);
    const auto started = std::find_if(told->begin(), told->end(), [](const auto& one) {
        return one.value.find("\"started\"") != std::string::npos;
    });
    ASSERT_NE(started, told->end());
    EXPECT_THAT(started->value, AllOf(HasSubstr("\"id\":\"" + move.id + "\""),
                                      HasSubstr("\"skill\":\"JointPtpMoveSkill\""),
                                      HasSubstr("\"server_url\":\"" + arm_.url() + "\"")));
    const auto steps = file_.open()->transitions(record.number);
    ASSERT_TRUE(steps);
    EXPECT_TRUE(std::any_of(steps->begin(), steps->end(),
                            [](const auto& one) { return one.step == "swing"; }));
}

TEST(RecordedMoveComponent, HasTheStreamOfItsRobotAsItsChild) {
    const RecordFile file(emptyFolder());
    const ServerProcess robot("ur5", file.serving());
    const ServerProcess component("ur5-move", file.serving({"--robot", robot.url()}));
    Watched move(component.url(), kMove);
    auto target = jointPosition(move.client(), *move);
    target.front() += 0.2;
    ASSERT_TRUE(move->runWith({"streamed", {{"TargetJointPosition", target}}}, inAMinute()));
    const auto record = file.awaitEnd(kMove);
    const auto stream = file.awaitEnd("PositionStreamSkill");
    EXPECT_EQ(stream.parent, "streamed");
    EXPECT_EQ(stream.parent_server, record.server);
    const auto children = file.open()->children(record.number);
    ASSERT_TRUE(children);
    ASSERT_EQ(children->size(), 1U);
    EXPECT_EQ(children->front().number, stream.number);
    const auto path = file.open()->path(record.number);
    ASSERT_TRUE(path);
    EXPECT_NEAR(path->back().actual[0], target.front(), 1e-2);
}

TEST(RecordsOfAServer, AreInItsStateFolderUnlessItIsToldOtherwise) {
    const auto folder = emptyFolder();
    {
        const ServerProcess server("iiwa", {"--port", "0", "--state", folder.string()});
        Watched arm(server.url(), kMove);
        ASSERT_TRUE(arm->startWith(
            {.parameters = {{"TargetJointPosition", jointPosition(arm.client(), *arm)}}}));
        EXPECT_EQ(RecordFile(folder).awaitEnd(kMove).server_name, "iiwa");
    }
    const auto other = folder / "other";
    {
        const ServerProcess off("iiwa",
                                {"--port", "0", "--state", other.string(), "--records", "off"});
    }
    EXPECT_TRUE(std::filesystem::exists(other)) << "the names of executions";
    EXPECT_FALSE(std::filesystem::exists(other / "records.db"));
    const auto wrong = runMetier({"serve", simulatedCell().string(), "--server", "iiwa", "--port",
                                  "0", "--records", "mysql://here"});
    EXPECT_NE(wrong.status, 0);
    EXPECT_THAT(wrong.output, HasSubstr("mysql://here"));
}

}  // namespace
}  // namespace metier::system_tests
