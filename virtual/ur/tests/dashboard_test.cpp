#include "dashboard.hpp"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include "robot_fixture.hpp"

namespace metier::virtual_ur {
namespace {

using testing::HasSubstr;
using testing::MatchesRegex;
using testing::StartsWith;

/// A folder that goes with the test.
class Folder {
public:
    Folder()
        : path(std::filesystem::temp_directory_path() /
               ("virtual_ur_dashboard_" + std::to_string(::getpid()))) {
        std::filesystem::create_directories(path);
    }
    ~Folder() { std::filesystem::remove_all(path); }
    void write(const std::string& name, const std::string& text) const {
        std::ofstream(path / name) << text;
    }

    std::filesystem::path path;
};

/// A robot with its dashboard, asked in lines.
class Desk {
public:
    explicit Desk(const std::string& model = "ur5", RobotOnTable::Values settings = {})
        : table(model, std::move(settings)),
          dashboard(table.robot, [this](std::string text) { logged = std::move(text); }) {}

    std::string ask(std::string_view line) { return dashboard.answer(line).line; }
    bool modeBecomes(const std::string& mode) {
        return table.until([&] { return ask("robotmode") == "Robotmode: " + mode; }, 5.0);
    }

    RobotOnTable table;
    std::string logged;
    Dashboard dashboard;
};

TEST(Dashboard, LeadsAnArmWithoutPowerToRunningAndBack) {
    Desk desk("ur5", {{"powered", false}});
    EXPECT_EQ(desk.ask("robotmode"), "Robotmode: POWER_OFF");
    EXPECT_EQ(desk.ask("power on"), "Powering on");
    ASSERT_TRUE(desk.modeBecomes("IDLE"));
    EXPECT_EQ(desk.ask("play"), "Failed to execute: play");
    EXPECT_EQ(desk.ask("brake release"), "Brake releasing");
    ASSERT_TRUE(desk.modeBecomes("RUNNING"));
    EXPECT_EQ(desk.ask("power off"), "Powering off");
    ASSERT_TRUE(desk.modeBecomes("POWER_OFF"));
}

TEST(Dashboard, LoadsPlaysPausesAndStopsAProgram) {
    const Folder folder;
    folder.write("wait.script", "def wait():\n  while True:\n    sync()\n  end\nend\n");
    folder.write("bad.script", "def bad(:\n");
    Desk desk("ur5e", {{"programs", folder.path.string()}});
    EXPECT_EQ(desk.ask("get loaded program"), "No program loaded");
    EXPECT_EQ(desk.ask("programState"), "STOPPED <unnamed>");
    EXPECT_EQ(desk.ask("play"), "Failed to execute: play");
    EXPECT_EQ(desk.ask("load none.urp"), "File not found: none.urp");
    EXPECT_EQ(desk.ask("load ../wait.urp"), "File not found: ../wait.urp");
    EXPECT_EQ(desk.ask("load bad.urp"), "Error while loading program: bad.urp");
    EXPECT_EQ(desk.ask("load wait.urp"), "Loading program: wait.urp");
    EXPECT_EQ(desk.ask("programState"), "STOPPED wait.urp");
    EXPECT_EQ(desk.ask("get loaded program"), "Loaded program: wait.urp");
    EXPECT_EQ(desk.ask("isProgramSaved"), "true wait.urp");
    EXPECT_EQ(desk.ask("running"), "Program running: false");
    EXPECT_EQ(desk.ask("pause"), "Failed to execute: pause");
    EXPECT_EQ(desk.ask("play"), "Starting program");
    desk.table.cycles(3);
    EXPECT_EQ(desk.ask("programState"), "PLAYING wait.urp");
    EXPECT_EQ(desk.ask("running"), "Program running: true");
    EXPECT_EQ(desk.ask("pause"), "Pausing program");
    ASSERT_TRUE(desk.table.runtimeBecomes(RuntimeState::paused));
    EXPECT_EQ(desk.ask("programState"), "PAUSED wait.urp");
    EXPECT_EQ(desk.ask("play"), "Starting program");
    ASSERT_TRUE(desk.table.runtimeBecomes(RuntimeState::playing));
    EXPECT_EQ(desk.ask("stop"), "Stopped");
    ASSERT_TRUE(desk.table.runtimeBecomes(RuntimeState::stopped));
    EXPECT_EQ(desk.ask("programState"), "STOPPED wait.urp");
}

TEST(Dashboard, LoadsFromTheFolderThatTheControllerHasItsProgramsIn) {
    const Folder folder;
    folder.write("wait.script", "def wait():\n  sync()\nend\n");
    Desk desk("ur5e", {{"programs", folder.path.string()}});
    EXPECT_EQ(desk.ask("load /programs/wait.urp"), "Loading program: /programs/wait.urp");
    EXPECT_EQ(desk.ask("programState"), "STOPPED wait.urp");
    EXPECT_EQ(desk.ask("load /ursim/programs/wait.urp"),
              "Loading program: /ursim/programs/wait.urp");
    const auto whole = (folder.path / "wait.urp").string();
    for (const auto& file : {whole, "/programs/" + whole, std::string("/programs/../wait.urp"),
                             std::string("/programs/"), std::string("/programs/none.urp")}) {
        EXPECT_EQ(desk.ask("load " + file), "File not found: " + file);
    }
}

TEST(Dashboard, SaysThatInstallationsLogsAndReportsAreDone) {
    for (const auto* model : {"ur5", "ur5e"}) {
        Desk desk(model);
        EXPECT_EQ(desk.ask("load installation default.installation"),
                  "Loading installation: default.installation");
        EXPECT_EQ(desk.ask("load installation"), "File not found: ");
        EXPECT_EQ(desk.ask("saveLog"), "Log saved to disk");
        EXPECT_EQ(desk.ask("generate flight report controller"),
                  "Flight Report generated with id:1");
        EXPECT_EQ(desk.ask("generate flight report "), "Flight Report generated with id:2");
        EXPECT_EQ(desk.ask("generate support file /programs"),
                  "Completed successfully:/programs/ursupport_20195599999.zip");
    }
    Desk local("ur5e", {{"remote_control", false}});
    EXPECT_THAT(local.ask("load installation default.installation"), HasSubstr("not allowed"));
}

TEST(Dashboard, TakesTheRolesThatThereAre) {
    Desk desk;
    EXPECT_EQ(desk.ask("getUserRole"), "PROGRAMMER");
    for (const auto& [role, stored] : {std::pair{"operator", "OPERATOR"},
                                       {"None", "NONE"},
                                       {"LOCKED", "LOCKED"},
                                       {"restricted", "RESTRICTED"},
                                       {"programmer", "PROGRAMMER"}}) {
        EXPECT_EQ(desk.ask(std::string("setUserRole ") + role),
                  std::string("Setting user role: ") + role);
        EXPECT_EQ(desk.ask("getUserRole"), stored);
    }
    EXPECT_EQ(desk.ask("setUserRole king"), "Failed setting user role: king");
    EXPECT_EQ(desk.ask("setUserRole"), "Failed setting user role: ");
    EXPECT_EQ(desk.ask("getUserRole"), "PROGRAMMER");
}

TEST(Dashboard, UnlocksAProtectiveStopAfterAWhile) {
    Desk desk;
    EXPECT_EQ(desk.ask("unlock protective stop"), "Failed to execute: unlock protective stop");
    desk.table.robot.protectiveStop({157, "collision"});
    EXPECT_EQ(desk.ask("safetymode"), "Safetymode: PROTECTIVE_STOP");
    EXPECT_EQ(desk.ask("robotmode"), "Robotmode: RUNNING");
    EXPECT_THAT(desk.ask("unlock protective stop"), StartsWith("Cannot unlock protective stop"));
    desk.table.seconds(5.1);
    EXPECT_EQ(desk.ask("close safety popup"), "closing safety popup");
    EXPECT_EQ(desk.ask("unlock protective stop"), "Protective stop releasing");
    EXPECT_EQ(desk.ask("safetymode"), "Safetymode: NORMAL");
}

TEST(Dashboard, RefusesPowerInAnEmergencyStop) {
    Desk desk;
    desk.table.robot.emergencyStop();
    ASSERT_TRUE(desk.modeBecomes("POWER_OFF"));
    EXPECT_EQ(desk.ask("safetymode"), "Safetymode: ROBOT_EMERGENCY_STOP");
    EXPECT_EQ(desk.ask("power on"), "Failed to execute: power on");
    EXPECT_EQ(desk.ask("brake release"), "Failed to execute: brake release");
    desk.table.robot.releaseEmergencyStop();
    EXPECT_EQ(desk.ask("brake release"), "Brake releasing");
    EXPECT_TRUE(desk.modeBecomes("RUNNING"));
}

TEST(Dashboard, RestartOfSafetyEndsWithoutPower) {
    Desk desk;
    desk.table.robot.protectiveStop({157, "collision"});
    EXPECT_EQ(desk.ask("restart safety"), "Restarting safety");
    EXPECT_TRUE(desk.modeBecomes("POWER_OFF"));
    EXPECT_EQ(desk.ask("safetymode"), "Safetymode: NORMAL");
}

TEST(Dashboard, TellsWhatTheRobotIs) {
    Desk cb3;
    EXPECT_THAT(cb3.ask("PolyscopeVersion"), MatchesRegex("URSoftware 3\\.15\\.[0-9.]+ \\(.*\\)"));
    EXPECT_EQ(cb3.ask("get robot model"), "UR5");
    EXPECT_THAT(cb3.ask("get serial number"), StartsWith("20"));
    Desk e_series("ur5e");
    EXPECT_THAT(e_series.ask("PolyscopeVersion"), StartsWith("URSoftware 5.12.6."));
    EXPECT_THAT(e_series.ask("version"), StartsWith("5.12.6."));
    EXPECT_EQ(e_series.ask("get robot model"), "UR5");
    EXPECT_EQ(e_series.ask("safetystatus"), "Safetystatus: NORMAL");
}

TEST(Dashboard, CommandsOfTheOtherSeriesAreNotUnderstood) {
    Desk cb3;
    for (const auto* line : {"version", "is in remote control", "safetystatus",
                             "get operational mode", "robotmodes", "", "Robotmode"}) {
        EXPECT_THAT(cb3.ask(line), StartsWith("could not understand")) << line;
    }
    Desk e_series("ur5e");
    EXPECT_THAT(e_series.ask("getUserRole"), StartsWith("could not understand"));
    EXPECT_EQ(cb3.ask("setUserRole operator"), "Setting user role: operator");
}

TEST(Dashboard, AnArmInLocalControlAnswersButDoesNothing) {
    Desk desk("ur5e", {{"remote_control", false}});
    EXPECT_EQ(desk.ask("is in remote control"), "false");
    EXPECT_THAT(desk.ask("power off"), HasSubstr("not allowed"));
    EXPECT_EQ(desk.ask("robotmode"), "Robotmode: RUNNING");
    desk.table.robot.setControl(Control::remote);
    EXPECT_EQ(desk.ask("is in remote control"), "true");
    EXPECT_EQ(desk.ask("power off"), "Powering off");
}

TEST(Dashboard, TakesTextForPopupAndLog) {
    Desk desk("ur5e");
    EXPECT_EQ(desk.ask("popup hello there"), "showing popup");
    EXPECT_TRUE(desk.table.wasReported(2, "hello there"));
    EXPECT_EQ(desk.ask("close popup"), "closing popup");
    EXPECT_EQ(desk.ask("addToLog it works"), "Added log message");
    EXPECT_EQ(desk.logged, "it works");
    EXPECT_EQ(desk.ask("addToLog"), "No log message to add");
    EXPECT_EQ(desk.ask("get operational mode"), "NONE");
    EXPECT_EQ(desk.ask("set operational mode manual"), "Operational mode MANUAL is set");
    EXPECT_EQ(desk.ask("get operational mode"), "MANUAL");
    EXPECT_THAT(desk.ask("set operational mode x"), HasSubstr("Failed"));
}

TEST(Dashboard, QuitAndShutdownEndTheConnection) {
    Desk desk;
    const auto quit = desk.dashboard.answer("quit\r");
    EXPECT_EQ(quit.line, "Disconnected");
    EXPECT_EQ(quit.then, Dashboard::Answer::Then::disconnect);
    EXPECT_EQ(desk.ask("shutdown"), "Shutting down");
}

}  // namespace
}  // namespace metier::virtual_ur
