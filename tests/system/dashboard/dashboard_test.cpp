// `metier dashboard` of real servers, as a browser sees it.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <future>
#include <nlohmann/json.hpp>
#include <optional>

#include "../installation.hpp"
#include "../metier_program.hpp"
#include "metier/records/recorder.hpp"
#include "tab.hpp"

namespace metier::system_tests {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;

ServerProcess dashboardOf(const std::vector<std::string>& servers) {
    std::vector<std::string> arguments{"dashboard", "--port", "0", "--records", "off"};
    arguments.insert(arguments.end(), servers.begin(), servers.end());
    return ServerProcess(metierCommand(arguments));
}

/// The key of the server at an address that was given on the command line.
std::string keyOf(const std::string& url) {
    return url.substr(std::string("opc.tcp://").size());
}

class DashboardTest : public ::testing::Test {
protected:
    void SetUp() override { awaitConnected(arm_->url()); }

    /// Waits until the page shows the content of the server.
    void awaitConnected(const std::string& url) {
        Tab tab(page_.url());
        const auto key = keyOf(url);
        tab.await("snapshot", [](const json&) { return true; });
        while (serverIn(tab.ask("/api/cell").body, key).at("connected") != true) {
            tab.await("server", [&](const json& server) { return server.at("key") == key; });
        }
    }
    static json serverIn(const json& cell, const std::string& key) {
        for (const auto& server : cell.at("servers")) {
            if (server.at("key") == key) {
                return server;
            }
        }
        return {};
    }
    json skill(const std::string& name) const {
        const auto server = serverIn(askPage(page_.url(), "/api/cell").body, key());
        for (const auto& one : server.at("skills")) {
            if (one.at("name") == name) {
                return one;
            }
        }
        return {};
    }
    static json fieldOf(const json& skill, const std::string& name) {
        for (const auto& field : skill.at("parameters")) {
            if (field.at("name") == name) {
                return field;
            }
        }
        return {};
    }
    std::string key() const { return keyOf(arm_->url()); }
    std::string move() const { return skill("JointPtpMoveSkill").at("key"); }
    /// A move that takes about `seconds` for its 1 rad.
    static json slowMove(double seconds) {
        return {{"TargetJointPosition", std::vector<double>(7, 1.0)},
                {"MaxVelocity", std::vector<double>(7, 1.0 / seconds)}};
    }
    static PageAnswer take(Tab& tab) {
        return tab.tell("/api/control", {{"server", "all"}, {"action", "take"}});
    }

    std::optional<ServerProcess> arm_{std::in_place, "iiwa",
                                      std::vector<std::string>{"--port", lastingPort()}};
    ServerProcess page_ = dashboardOf({arm_->url()});
};

TEST_F(DashboardTest, ShowsWhatAServerOffers) {
    const auto cell = askPage(page_.url(), "/api/cell").body;
    ASSERT_EQ(cell.at("arms").size(), 1U);
    const auto& arm = cell.at("arms").at(0);
    EXPECT_EQ(arm.at("model"), "iiwa7");
    EXPECT_EQ(arm.at("joints").size(), 7U);
    EXPECT_FALSE(arm.at("visuals").empty());
    const auto move = skill("JointPtpMoveSkill");
    EXPECT_EQ(move.at("arm"), arm.at("key"));
    EXPECT_EQ(move.at("can").at("check"), true);
    const auto target = fieldOf(move, "TargetJointPosition");
    EXPECT_EQ(target.at("role"), "joints");
    EXPECT_EQ(target.at("rank"), 7);
    EXPECT_EQ(target.at("unit"), "rad");
    EXPECT_EQ(fieldOf(skill("CartesianPtpMoveSkill"), "TargetPosition").at("role"), "pose");
}

TEST_F(DashboardTest, DrivesASkillThroughAllItsStates) {
    Tab tab(page_.url());
    ASSERT_EQ(take(tab).status, 200);
    EXPECT_EQ(tab.await("control", [](const json& c) { return c.at("mine") == true; }).at("server"),
              key());
    const auto key = move();
    const auto checked =
        tab.tell("/api/skills/check", {{"key", key}, {"parameters", slowMove(20)}});
    EXPECT_EQ(checked.body.at("possible"), true) << checked.body;
    EXPECT_GT(checked.body.at("duration"), 19.0);
    EXPECT_GT(checked.body.at("preview").size(), 10U);

    const auto started =
        tab.tell("/api/skills/start", {{"key", key}, {"parameters", slowMove(20)}});
    ASSERT_EQ(started.status, 200) << started.error();
    EXPECT_EQ(tab.awaitState(key, "Running").at("execution"), started.body.at("execution"));
    tab.await("live", [](const json& live) {
        return live.contains("arms") && live.at("arms").begin()->contains("q");
    });
    EXPECT_EQ(tab.tell("/api/skills/suspend", {{"key", key}}).status, 200);
    tab.awaitState(key, "Suspended");
    EXPECT_EQ(tab.tell("/api/skills/resume", {{"key", key}}).status, 200);
    tab.awaitState(key, "Running");
    const auto halted = tab.tell("/api/halt");
    EXPECT_EQ(halted.body.at("failed"), json::array()) << halted.body;
    EXPECT_EQ(tab.awaitState(key, "Halted").at("reason"), "ByClient");
    EXPECT_EQ(tab.tell("/api/skills/reset", {{"key", key}}).status, 200);
    tab.awaitState(key, "Ready");
}

TEST_F(DashboardTest, IsReadOnlyUntilControlIsTaken) {
    Tab tab(page_.url());
    const auto refused = tab.tell("/api/skills/start", {{"key", move()}});
    EXPECT_EQ(refused.status, 409);
    EXPECT_THAT(refused.error(), HasSubstr("take control"));
}

TEST_F(DashboardTest, RefusesASecondTabWithWords) {
    Tab first(page_.url());
    ASSERT_EQ(take(first).status, 200);
    Tab second(page_.url());
    const auto refused = take(second);
    EXPECT_EQ(refused.status, 409);
    EXPECT_THAT(refused.error(), HasSubstr("metier dashboard, tab " + first.id().substr(0, 4)));
    EXPECT_EQ(first.tell("/api/control", {{"server", "all"}, {"action", "release"}}).status, 200);
    EXPECT_EQ(take(second).status, 200);
}

TEST_F(DashboardTest, GivesBackTheControlOfATabThatIsClosed) {
    const auto key = move();
    Tab watching(page_.url());
    {
        Tab tab(page_.url());
        ASSERT_EQ(take(tab).status, 200);
        const auto started =
            tab.tell("/api/skills/start", {{"key", key}, {"parameters", slowMove(100)}});
        ASSERT_EQ(started.status, 200) << started.error();
        watching.awaitState(key, "Running");
    }
    EXPECT_EQ(watching.awaitState(key, "Halted").at("reason"), "OwnerLost");
    EXPECT_EQ(take(watching).status, 200);
}

TEST_F(DashboardTest, HaltsForATabWithoutControl) {
    const auto key = move();
    Tab commanding(page_.url());
    ASSERT_EQ(take(commanding).status, 200);
    ASSERT_EQ(
        commanding.tell("/api/skills/start", {{"key", key}, {"parameters", slowMove(100)}}).status,
        200);
    Tab watching(page_.url());
    const auto halted = watching.tell("/api/skills/halt", {{"key", key}});
    EXPECT_EQ(halted.body.at("halted"), json::array({key})) << halted.body;
    EXPECT_EQ(commanding.awaitState(key, "Halted").at("reason"), "ByClient");
}

TEST_F(DashboardTest, SaysWhyAPoseIsOutOfReach) {
    Tab tab(page_.url());
    const auto checked =
        tab.tell("/api/skills/check", {{"key", skill("CartesianPtpMoveSkill").at("key")},
                                       {"parameters", {{"TargetPosition", {9, 0, 0, 0, 0, 0}}}}});
    ASSERT_EQ(checked.status, 200) << checked.error();
    EXPECT_EQ(checked.body.at("possible"), false);
    EXPECT_NE(checked.body.at("message"), "");
    const auto wrong =
        tab.tell("/api/skills/check", {{"key", move()}, {"parameters", {{"Sped", 1}}}});
    EXPECT_EQ(wrong.status, 404);
    EXPECT_THAT(wrong.error(), HasSubstr("Sped"));
}

TEST_F(DashboardTest, ShowsAServerThatDiesAndComesBack) {
    Tab tab(page_.url());
    const auto key = move();
    ASSERT_EQ(take(tab).status, 200);
    const auto port = arm_->port();
    const auto server = this->key();
    arm_->kill();
    EXPECT_EQ(
        tab.await("server", [&](const json& s) { return s.at("connected") == false; }).at("key"),
        server);
    tab.awaitState(key, "Unknown");
    EXPECT_EQ(tab.tell("/api/skills/start", {{"key", key}}).status, 502);
    arm_.emplace("iiwa", std::vector<std::string>{"--port", port});
    tab.await("server", [&](const json& s) { return s.at("connected") == true; });
    EXPECT_EQ(tab.tell("/api/skills/start", {{"key", key}}).status, 409) << "control was lost";
    EXPECT_EQ(take(tab).status, 200);
    EXPECT_EQ(tab.tell("/api/skills/check", {{"key", key}, {"parameters", slowMove(20)}}).status,
              200);
}

class ClosedDashboard : public ::testing::Test {
protected:
    ClosedDashboard() {
        EXPECT_EQ(here_.run({"user", "add", "anna"}, "correct horse").status, 0);
        EXPECT_EQ(here_.run({"user", "add", "otto", "--role", "Observer"}, "battery staple").status,
                  0);
        server_.emplace(here_.serve("iiwa", lastingPort()));
        page_.emplace(
            here_.command({"dashboard", server_->url(), "--port", "0", "--records", "off"}));
    }
    PageAnswer logIn(const std::string& user, const std::string& password) {
        PageAnswer answer;
        do {  // 502: the page has not reached the server yet
            answer = tellPage(page_->url(), "/api/login", {{"user", user}, {"password", password}});
        } while (answer.status == 502 && std::chrono::steady_clock::now() < deadline_);
        return answer;
    }

    const SteadyTime deadline_ = inAMinute();
    const Installation here_{"here"};
    std::optional<ServerProcess> server_;
    std::optional<ServerProcess> page_;
};

TEST_F(ClosedDashboard, LetsPeopleInAsTheServersDo) {
    EXPECT_EQ(askPage(page_->url(), "/api/cell").status, 401);
    const auto anna = logIn("anna", "correct horse");
    ASSERT_EQ(anna.status, 200) << anna.error();
    EXPECT_EQ(anna.body.at("role"), "operator");
    const auto port = page_->url().substr(page_->url().rfind(':') + 1);
    EXPECT_THAT(anna.cookie, HasSubstr("metier_" + port + "="));
    Tab tab(page_->url(), anna.cookie);
    const auto taken = tab.tell("/api/control", {{"server", "all"}, {"action", "take"}});
    EXPECT_EQ(taken.status, 200) << taken.error();
    EXPECT_THAT(tab.await("control", [](const json& c) { return c.at("mine") == true; })
                    .at("owner")
                    .get<std::string>(),
                HasSubstr("of anna"));
    EXPECT_EQ(tab.tell("/api/halt").body.at("failed"), json::array());

    EXPECT_EQ(tellPage(page_->url(), "/api/logout", json::object(), anna.cookie).status, 200);
    EXPECT_EQ(askPage(page_->url(), "/api/cell", anna.cookie).status, 401);
}

TEST_F(ClosedDashboard, EndsTheTabsOfWhoeverLogsOut) {
    const auto anna = logIn("anna", "correct horse");
    ASSERT_EQ(anna.status, 200) << anna.error();
    Tab tab(page_->url(), anna.cookie);
    ASSERT_EQ(tab.tell("/api/control", {{"server", "all"}, {"action", "take"}}).status, 200);
    tab.await("control", [](const json& c) { return c.at("mine") == true; });
    const auto again = logIn("anna", "correct horse");
    Tab other(page_->url(), again.cookie);

    EXPECT_EQ(tellPage(page_->url(), "/api/logout", json::object(), anna.cookie).status, 200);
    other.await("control", [](const json& c) { return c.at("owner") == ""; });
    EXPECT_TRUE(tab.awaitEnd());
}

TEST_F(ClosedDashboard, TriesNoMorePasswordsAtATimeThanOneAfterAnother) {
    ASSERT_EQ(logIn("otto", "battery staple").status, 200);  // the servers are reached
    std::vector<std::future<int>> guesses;
    for (int guess = 0; guess < 20; ++guess) {
        guesses.push_back(std::async(std::launch::async, [this, guess] {
            return logIn("anna", "wrong " + std::to_string(guess)).status;
        }));
    }
    int tried = 0;
    for (auto& guess : guesses) {
        tried += guess.get() == 401 ? 1 : 0;
    }
    EXPECT_LE(tried, 4);
}

TEST_F(ClosedDashboard, LetsAnObserverLookAlone) {
    const auto otto = logIn("otto", "battery staple");
    ASSERT_EQ(otto.status, 200) << otto.error();
    EXPECT_EQ(otto.body.at("role"), "observer");
    Tab tab(page_->url(), otto.cookie);
    const auto refused = tab.tell("/api/control", {{"server", "all"}, {"action", "take"}});
    EXPECT_EQ(refused.status, 403) << refused.body;
    EXPECT_NE(tab.tell("/api/halt").body.at("failed"), json::array());
}

TEST_F(ClosedDashboard, LetsTheRightOnesInWhateverNamesAreMadeUp) {
    for (int round = 0; round < 25; ++round) {
        for (int guess = 0; guess < 2; ++guess) {
            const auto name = "nobody-" + std::to_string(2 * round + guess);
            EXPECT_EQ(logIn(name, "a guess").status, 401);
        }
        const auto anna = logIn("anna", "correct horse");
        ASSERT_EQ(anna.status, 200) << round << ": " << anna.error();
        EXPECT_EQ(tellPage(page_->url(), "/api/halt", json::object(), anna.cookie).status, 200);
        tellPage(page_->url(), "/api/logout", json::object(), anna.cookie);
    }
}

TEST_F(ClosedDashboard, BelievesNoOpenServerInThePlaceOfAClosedOne) {
    const auto anna = logIn("anna", "correct horse");
    ASSERT_EQ(anna.status, 200) << anna.error();
    Tab tab(page_->url(), anna.cookie);
    const auto port = server_->port();
    server_->kill();
    tab.await("server", [](const json& server) { return server.at("connected") == false; });
    const ServerProcess impostor("iiwa", {"--port", port});
    const auto shown = tab.await("server", [](const json& server) {
        const auto& error = server.at("error");
        return error.is_string() &&
               error.get<std::string>().find("closed before") != std::string::npos;
    });
    EXPECT_EQ(shown.at("connected"), false);
    for (const auto* path : {"/api/cell", "/api/records", "/api/stream"}) {
        EXPECT_EQ(askPage(page_->url(), path).status, 401) << path;
    }
    EXPECT_EQ(tellPage(page_->url(), "/api/halt", json::object()).status, 401);
    EXPECT_EQ(tellPage(page_->url(), "/api/skills/start", json::object()).status, 401);
}

TEST(DashboardOfALab, IsServedToThisMachineAlone) {
    const ServerProcess arm("iiwa");
    for (const auto* address : {"0.0.0.0", "127.0.0.1.example"}) {
        const auto refused =
            runMetier({"dashboard", arm.url(), "--port", "0", "--address", address});
        EXPECT_EQ(refused.status, 2) << address;
        EXPECT_THAT(refused.output, HasSubstr("is not a loopback address"));
    }
}

TEST_F(ClosedDashboard, MakesWhoeverGuessesWait) {
    PageAnswer answer;
    // The fourth at the latest; more only if the machine lets the first wait of a second pass by.
    for (int attempt = 0; attempt < 6 && answer.status != 429; ++attempt) {
        answer = logIn("anna", "wrong " + std::to_string(attempt));
    }
    EXPECT_EQ(answer.status, 429) << answer.body;
    EXPECT_THAT(answer.error(), AllOf(HasSubstr("wait"), HasSubstr(" s")));
    EXPECT_EQ(logIn("anna", "correct horse").status, 429);
    EXPECT_EQ(logIn("otto", "battery staple").status, 200) << "others are not held up";
}

/// A cell whose file says where its one server, which is away, has recorded a move.
std::filesystem::path recordedCell() {
    const auto folder = std::filesystem::path(::testing::TempDir()) / "dashboard_records";
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder);
    std::ofstream(folder / "cell.toml") << R"(
        name = "recorded"
        [records]
        url = "cell.db"
        [[server]]
        name = "iiwa"
        kind = "gripper"
        port = 1
        driver = { type = "wsg50", controller = "127.0.0.1" }
        nodeset = "wsg50"
        skills = ["GraspGripperSkill"]
    )";
    records::Recorder::Options options;
    options.url = (folder / "cell.db").string();
    options.server = "urn:test:iiwa";
    const auto recorder = records::Recorder::create(std::move(options)).value();
    records::ExecutionRow execution;
    execution.id = "move-of-this-cell";
    recorder->begin(std::move(execution));
    return folder / "cell.toml";
}

TEST(DashboardOfACell, ShowsTheRecordsOfItsFile) {
    const auto cell = recordedCell().string();
    const ServerProcess page(metierCommand({"dashboard", "--cell", cell, "--port", "0"}));
    const auto shown = askPage(page.url(), "/api/records").body.at("records");
    ASSERT_EQ(shown.size(), 1U) << shown;
    EXPECT_EQ(shown.at(0).at("id"), "move-of-this-cell");
    const ServerProcess other(
        metierCommand({"dashboard", "--cell", cell, "--port", "0", "--records", "off"}));
    EXPECT_EQ(askPage(other.url(), "/api/records").body.at("records"), json::array());
}

}  // namespace
}  // namespace metier::system_tests
