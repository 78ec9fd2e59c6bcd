// Records from the command line: listed, shown, followed, drawn, exported and run again.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>

#include <cmath>
#include <csignal>
#include <fstream>
#include <nlohmann/json.hpp>
#include <pugixml.hpp>

#include "metier/records/recorder.hpp"
#include "metier_program.hpp"

namespace metier::system_tests {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr int kSuccess = 0;
constexpr int kFailed = 1;
constexpr int kUsage = 2;
constexpr auto kMidnight = UtcTime(1'795'305'600s);  // 2026-11-22

std::vector<std::string> lines(const std::string& text) {
    std::vector<std::string> all;
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);) {
        all.push_back(line);
    }
    return all;
}

class History : public ::testing::Test {
protected:
    History() { std::filesystem::remove_all(folder_); }

    std::unique_ptr<records::Recorder> recorder(const std::string& server = "urn:test:iiwa") {
        return records::Recorder::create({.url = file_, .server = server}).value();
    }
    static records::ExecutionRow move(const std::string& id, std::chrono::seconds after = 0s) {
        records::ExecutionRow e;
        e.id = id;
        e.server_name = "iiwa";
        e.skill = "JointPtpMoveSkill";
        e.controller = "IiwaController";
        e.device = "LBR iiwa 7 R800";
        e.user = "anna";
        e.parameters = R"({"TargetJointPosition":[0,0.2,0,-1.4,0,1.2,0],"SpeedOverride":null})";
        e.started = kMidnight + after;
        e.state = "Running";
        return e;
    }
    static records::Outcome halted(std::chrono::seconds after, const std::string& why) {
        return {.time = kMidnight + after,
                .state = "Halted",
                .reason = "Error",
                .reason_text = why,
                .result = {},
                .missed_cycles = 0};
    }
    static records::Outcome finished(std::chrono::seconds after) {
        return {.time = kMidnight + after,
                .state = "Ready",
                .reason = "Finished",
                .reason_text = {},
                .result = R"({"Duration":1.0})",
                .missed_cycles = 3};
    }
    /// A move that finished, with its path; one of another user that was halted; one under way.
    void recordThree() {
        const auto recording = recorder();
        const auto first = recording->begin(move("m-1"));
        recording->transition(first, {.time = kMidnight, .from = "Ready", .to = "Running"});
        for (int i = 0; i <= 50; ++i) {
            const double angle = 0.2 * (1 - std::cos(M_PI * i / 50.0));
            const std::array joints{angle, 0.2, 0.0, -1.4, 0.0, 1.2, -angle};
            recording->sample(first, {.time = 0.02 * i, .actual = records::SampleValues(joints)});
        }
        recording->transition(
            first,
            {.time = kMidnight + 1s, .from = "Running", .to = "Ready", .reason = "Finished"});
        recording->end(first, finished(1s));
        auto second = move("m-2", 10s);
        second.user = "ben";
        recording->end(recording->begin(second), halted(11s, "axis 2: 3.5 over\x1b[2J limit 3.1"));
        recording->begin(move("m-3", 20s));
        ASSERT_TRUE(recording->flush(inAMinute()));
    }
    Finished run(std::vector<std::string> arguments, Errors errors = Errors::with_output) const {
        arguments.insert(arguments.end(), {"--records", file_});
        return runMetier(arguments, errors);
    }
    /// The ids of the listed executions.
    std::vector<std::string> listed(std::vector<std::string> filter) const {
        filter.insert(filter.begin(), {"history", "--json"});
        const auto list = run(filter, Errors::left_out);
        EXPECT_EQ(list.status, kSuccess) << list.output;
        std::vector<std::string> ids;
        for (const auto& line : lines(list.output)) {
            ids.push_back(json::parse(line).at("id"));
        }
        return ids;
    }

    const std::filesystem::path folder_ =
        std::filesystem::path(::testing::TempDir()) / "history" /
        ::testing::UnitTest::GetInstance()->current_test_info()->name();
    const std::string file_ = (folder_ / "records.db").string();
};

TEST_F(History, ListsTheNewestFirstWithWhatPeopleLookFor) {
    recordThree();
    const auto list = run({"history"});
    EXPECT_EQ(list.status, kSuccess);
    const auto shown = lines(list.output);
    ASSERT_EQ(shown.size(), 4U) << list.output;
    EXPECT_THAT(shown[0], AllOf(HasSubstr("number"), HasSubstr("state")));
    EXPECT_THAT(shown[1], AllOf(HasSubstr("2026-11-22T00:00:20.000Z"), HasSubstr("Running")));
    EXPECT_THAT(shown[2], AllOf(HasSubstr("ben"), HasSubstr("Halted (Error): axis 2: 3.5 over"),
                                Not(HasSubstr("\x1b"))));
    EXPECT_THAT(shown[3], AllOf(HasSubstr("1.000 s"), HasSubstr("iiwa"),
                                HasSubstr("JointPtpMoveSkill"), HasSubstr("Ready (Finished)")));
}

TEST_F(History, FiltersAndPages) {
    recordThree();
    EXPECT_THAT(listed({}), ElementsAre("m-3", "m-2", "m-1"));
    EXPECT_THAT(listed({"--user", "anna", "--state", "Ready"}), ElementsAre("m-1"));
    EXPECT_THAT(listed({"--text", "OVER"}), ElementsAre("m-2"));
    EXPECT_THAT(listed({"--since", "2026-11-22T00:00:10", "--until", "2026-11-22T00:00:20Z"}),
                ElementsAre("m-2"));
    EXPECT_THAT(listed({"--count", "2"}), ElementsAre("m-3", "m-2"));
    EXPECT_THAT(listed({"--count", "2", "--before", "2"}), ElementsAre("m-1"));
    EXPECT_THAT(run({"history", "--count", "2"}).output, HasSubstr("more: --before 2"));
    EXPECT_THAT(listed({"--server", "urn:test:iiwa", "--skill", "Nothing"}), ElementsAre());
    const auto wrong = run({"history", "--since", "yesterday"});
    EXPECT_EQ(wrong.status, kUsage);
    EXPECT_THAT(wrong.output, HasSubstr("'yesterday' is no time"));
}

TEST_F(History, ShowsAllOfOneByNumberOrId) {
    recordThree();
    for (const auto* id : {"1", "m-1"}) {
        const auto shown = run({"history", "show", id});
        EXPECT_EQ(shown.status, kSuccess) << shown.output;
        EXPECT_THAT(shown.output,
                    AllOf(HasSubstr("execution 1 (m-1)"), HasSubstr("urn:test:iiwa"),
                          HasSubstr("\"TargetJointPosition\":[0,0.2"), HasSubstr("51 samples"),
                          HasSubstr("1.000 s  Running to Ready, Finished")));
    }
    const auto all =
        json::parse(run({"history", "show", "m-1", "--json"}, Errors::left_out).output);
    EXPECT_EQ(all.at("missed_cycles"), 3);
    EXPECT_EQ(all.at("transitions").size(), 2U);
    EXPECT_EQ(all.at("path").size(), 51U);
    EXPECT_EQ(all.at("path").at(50).at("time"), 1.0);
    const auto unknown = run({"history", "show", "m-9"});
    EXPECT_EQ(unknown.status, kFailed);
    EXPECT_THAT(unknown.output, HasSubstr("no execution 'm-9'"));
}

TEST_F(History, FollowsWhatComesFromBeforeTheFirstRecord) {
    auto following = link::ChildProcess::start(
                         metierCommand({"history", "--follow", "--json", "--records", file_}),
                         link::ErrorOutput::with_output)
                         .value();
    EXPECT_THAT(following.readLine(inAMinute()).value(),
                HasSubstr("there are no records; waiting"));
    const auto next = [&following] {
        const auto record = json::parse(following.readLine(inAMinute()).value());
        return record.at("id").get<std::string>() + " " + record.at("state").get<std::string>();
    };
    const auto recording = recorder();
    const auto key = recording->begin(move("m-1"));
    EXPECT_EQ(next(), "m-1 Running");
    recording->end(key, finished(1s));
    EXPECT_EQ(next(), "m-1 Ready");
    recording->end(recording->begin(move("m-2")), halted(2s, "axis 1"));
    auto last = next();
    if (last == "m-2 Running") {  // if it was followed just between begin and end
        last = next();
    }
    EXPECT_EQ(last, "m-2 Halted");
    following.signal(SIGINT);
    EXPECT_EQ(following.waitUntil(inAMinute()), kSuccess);
}

TEST_F(History, FollowsNobodyAnyLongerOnceItsReaderHasGone) {
    recordThree();
    auto following =
        link::ChildProcess::start(
            {"/bin/sh", "-c",
             fmt::format("{{ {} history --follow --records {}; echo ended >&2; }} | head -n 1",
                         fmt::join(metierCommand({}), " "), file_)},
            link::ErrorOutput::with_output)
            .value();
    EXPECT_THAT(following.readLine(inAMinute()).value(), HasSubstr("number"));
    EXPECT_EQ(following.readLine(inAMinute()).value(), "ended");
}

TEST_F(History, NamesAStoreThatIsNotThereOrIsNone) {
    const auto missing = run({"history"});
    EXPECT_EQ(missing.status, kFailed);
    EXPECT_THAT(missing.output, AllOf(HasSubstr(file_), HasSubstr("there are no records")));
    std::filesystem::create_directories(folder_);
    std::ofstream(file_) << std::string(5'000, 'x');
    EXPECT_THAT(run({"history"}).output, HasSubstr("is no SQLite file"));
    const auto url = runMetier({"history", "--records", "http://x/y"});
    EXPECT_EQ(url.status, kUsage) << url.output;
    const auto folder = runMetier({"history", "--records", folder_.string()});
    EXPECT_THAT(folder.output, HasSubstr("is a folder"));
    EXPECT_EQ(run({"history", "--before", "-1"}).status, kUsage);
}

TEST_F(History, DrawsTheRecordedPathOfTheRobotThatTheRecordNames) {
    recordThree();
    const auto svg = (folder_ / "path.svg").string();
    for (const auto* command : {"plot", "replay"}) {
        std::filesystem::remove(svg);
        const auto drawn = run({command, "m-1", "--svg", svg});
        EXPECT_EQ(drawn.status, kSuccess) << drawn.output;
        pugi::xml_document document;
        ASSERT_TRUE(document.load_file(svg.c_str()));
        for (int axis = 1; axis <= 7; ++axis) {
            const auto curve = fmt::format("//polyline[@class='curve velocity axis{}']", axis);
            EXPECT_EQ(document.select_nodes(curve.c_str()).size(), 1U);
        }
        const std::string title = document.select_node("//*[@class='title']").node().text().get();
        EXPECT_EQ(title, "JointPtpMoveSkill of LBR iiwa 7 R800, 2026-11-22T00:00:00.000Z, Ready");
    }
    const auto other = run({"plot", "m-1", "--robot", "ur5", "--svg", svg});
    EXPECT_EQ(other.status, kUsage);
    EXPECT_THAT(other.output, HasSubstr("7 joint positions, ur5 has 6 axes"));
    const auto empty = run({"plot", "2", "--svg", svg});
    EXPECT_EQ(empty.status, kFailed);
    EXPECT_THAT(empty.output, HasSubstr("0 joint positions were recorded"));
    const auto unsaid = run({"replay", "m-1"});
    EXPECT_EQ(unsaid.status, kUsage);
    EXPECT_THAT(unsaid.output, HasSubstr("--run"));
}

TEST_F(History, ExportsATraceWithChildrenOfOtherServers) {
    const auto pick = recorder("urn:test:pick");
    const auto iiwa = recorder();
    auto parent = move("p-1");
    parent.server_name = "pick";
    parent.skill = "PickPlaceSkill";
    pick->end(pick->begin(parent), finished(9s));
    auto child = move("p-1/approach", 1s);
    child.parent = "p-1";
    child.parent_server = "urn:test:pick";
    iiwa->end(iiwa->begin(child), finished(4s));
    ASSERT_TRUE(pick->flush(inAMinute()) && iiwa->flush(inAMinute()));
    const auto trace = run({"trace", "p-1"}, Errors::left_out);
    ASSERT_EQ(trace.status, kSuccess) << trace.output;
    std::vector<std::string> slices;
    const auto read = json::parse(trace.output);
    for (const auto& event : read.at("traceEvents")) {
        if (event.at("ph") == "X") {
            slices.push_back(fmt::format("{} {} {}", event.at("pid").get<int>(),
                                         event.at("name").get<std::string>(),
                                         event.at("dur").get<std::int64_t>()));
        }
    }
    EXPECT_THAT(slices, ElementsAre("1 PickPlaceSkill 9000000", "2 JointPtpMoveSkill 3000000"));
    EXPECT_EQ(run({"trace", "nobody"}).status, kFailed);
}

TEST_F(History, ExportsACopyThatIsWholeWhileServersRecord) {
    const auto recording = recorder();
    recording->end(recording->begin(move("m-1")), finished(1s));
    recording->begin(move("m-2", 2s));
    ASSERT_TRUE(recording->flush(inAMinute()));
    const auto copy = (folder_ / "copy.db").string();
    const auto done = run({"history", "export", copy});
    EXPECT_EQ(done.status, kSuccess) << done.output;
    EXPECT_THAT(done.output, HasSubstr("2 executions are in " + copy));
    const auto list = runMetier({"history", "--json", "--records", copy}, Errors::left_out);
    EXPECT_THAT(lines(list.output), ElementsAre(HasSubstr("\"m-2\""), HasSubstr("\"m-1\"")));
    const auto again = run({"history", "export", copy});
    EXPECT_EQ(again.status, kFailed);
    EXPECT_THAT(again.output, AllOf(HasSubstr(copy), HasSubstr("exists already")));
    EXPECT_EQ(run({"history", "export"}).status, kUsage);
}

TEST_F(History, RunsTheSameAgainAfterCheck) {
    const ServerProcess server("iiwa");
    const auto client = connectTo(server.url());
    const auto skill = openSkill(*client, "JointPtpMoveSkill");
    const auto home = jointPosition(*client, skill);
    auto target = home;
    target[0] += 0.1;
    {
        const auto recording = recorder();
        auto possible = move("m-1");
        possible.controller = skill.address().controllerName();
        possible.parameters =
            json{{"TargetJointPosition", target}, {"MaxVelocity", nullptr}}.dump();
        recording->end(recording->begin(possible), finished(1s));
        auto impossible = possible;
        impossible.id = "m-2";
        auto beyond = home;
        beyond[1] = 9.0;
        impossible.parameters = json{{"TargetJointPosition", beyond}}.dump();
        recording->end(recording->begin(impossible), finished(1s));
        auto unknown = possible;
        unknown.id = "m-3";
        unknown.parameters = R"({"Colour":"red"})";
        recording->end(recording->begin(unknown), finished(1s));
        ASSERT_TRUE(recording->flush(inAMinute()));
    }
    const auto refused = run({"replay", "m-2", "--run", "--url", server.url()});
    EXPECT_EQ(refused.status, kFailed);
    EXPECT_THAT(refused.output, AllOf(HasSubstr("not started"), HasSubstr("9")));
    const auto gone = run({"replay", "m-3", "--run", "--url", server.url()});
    EXPECT_EQ(gone.status, kFailed);
    EXPECT_THAT(gone.output, HasSubstr("no parameter 'Colour' any more"));
    EXPECT_EQ(jointPosition(*client, skill), home) << "nothing may have moved";

    const auto again = run({"replay", "m-1", "--run", "--url", server.url()});
    EXPECT_EQ(again.status, kSuccess) << again.output;
    EXPECT_THAT(again.output, AllOf(HasSubstr("Check: possible"), HasSubstr("done")));
    EXPECT_NEAR(jointPosition(*client, skill)[0], target[0], 1e-3);

    const auto where = run({"replay", "m-1", "--run"});
    EXPECT_EQ(where.status, kUsage);
    EXPECT_THAT(where.output, HasSubstr("say where server 'iiwa' is"));
}

}  // namespace
}  // namespace metier::system_tests
