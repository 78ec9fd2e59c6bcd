// The command line as its users see it: what it prints, what it refuses and its exit statuses.
#include <gmock/gmock.h>
#include <unistd.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "metier_program.hpp"

namespace metier::system_tests {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::SizeIs;

constexpr int kSuccess = 0;
constexpr int kFailed = 1;
constexpr int kUsage = 2;
// Nobody listens on the port of a service that sends nothing but time.
constexpr const char* kNobody = "opc.tcp://127.0.0.1:37";
const std::vector<std::string> kCommands{
    "demo",  "up",   "serve",      "list",  "run",  "watch",   "halt",   "square", "fk",   "ik",
    "check", "plot", "completion", "trust", "user", "history", "replay", "trace",  "robot"};

/// A cell file of the test, removed at its end.
class CellFile {
public:
    explicit CellFile(const std::string& text)
        : path_(std::filesystem::path(::testing::TempDir()) /
                ("cell_" + std::to_string(getpid()) + ".toml")) {
        std::ofstream(path_) << text;
    }
    ~CellFile() { std::filesystem::remove(path_); }
    CellFile(const CellFile&) = delete;
    CellFile& operator=(const CellFile&) = delete;

    std::string name() const { return path_.string(); }

private:
    std::filesystem::path path_;
};

TEST(Cli, HelpNamesEveryCommand) {
    const auto help = runMetier({"--help"});
    EXPECT_EQ(help.status, kSuccess);
    for (const auto& command : kCommands) {
        EXPECT_THAT(help.output, HasSubstr("  " + command)) << help.output;
    }
    EXPECT_THAT(help.output, HasSubstr("not safety-rated"));
}

TEST(Cli, TakesNoPasswordThatEverybodySees) {
    const std::string url = "postgresql://anna:secret@127.0.0.1:1/records";
    for (const auto& command : std::vector<std::vector<std::string>>{
             {"history", "--records", url},
             {"dashboard", kNobody, "--port", "0", "--records", url},
             {"serve", simulatedCell().string(), "--server", "iiwa", "--records", url}}) {
        const auto refused = runMetier(command);
        EXPECT_EQ(refused.status, kUsage) << command.front();
        EXPECT_THAT(refused.output, HasSubstr("put it in ~/.pgpass"));
    }
}

TEST(Cli, EveryCommandHasHelpOfItsOwn) {
    for (const auto& command : kCommands) {
        const auto help = runMetier({command, "--help"});
        EXPECT_EQ(help.status, kSuccess) << command;
        EXPECT_THAT(help.output, HasSubstr("Usage: metier " + command)) << help.output;
    }
}

TEST(Cli, TellsItsVersion) {
    const auto version = runMetier({"--version"});
    EXPECT_EQ(version.status, kSuccess);
    EXPECT_THAT(version.output, ::testing::MatchesRegex("[0-9]+\\.[0-9]+\\.[0-9]+\n"));
}

TEST(Cli, AWrongCommandLineIsUsageAndShowsTheHelp) {
    for (const auto& line : std::vector<std::vector<std::string>>{
             {}, {"dance"}, {"up"}, {"run", kNobody}, {"list", "--what"}, {"completion", "tcsh"}}) {
        const auto refused = runMetier(line);
        EXPECT_EQ(refused.status, kUsage) << refused.output;
        EXPECT_THAT(refused.output, HasSubstr("Usage: metier")) << refused.output;
    }
}

TEST(Cli, AServerThatIsNotThereIsAFailureThatNamesIt) {
    for (const auto& line : std::vector<std::vector<std::string>>{{"list", kNobody},
                                                                  {"run", kNobody, "AnySkill"},
                                                                  {"watch", kNobody},
                                                                  {"halt", kNobody},
                                                                  {"square", kNobody}}) {
        const auto refused = runMetier(line);
        EXPECT_EQ(refused.status, kFailed) << line.front();
        EXPECT_THAT(refused.output, AllOf(HasSubstr("metier: "), HasSubstr(kNobody)));
    }
}

TEST(Cli, ListAsJsonTellsOfAServerThatIsNotThere) {
    const auto list = runMetier({"list", "--json", kNobody}, Errors::left_out);
    EXPECT_EQ(list.status, kFailed);
    const auto json = nlohmann::json::parse(list.output);
    ASSERT_THAT(json, SizeIs(1));
    EXPECT_EQ(json[0].at("url"), kNobody);
    EXPECT_TRUE(json[0].contains("error"));
}

TEST(Cli, CompletionScriptsParseInTheirShell) {
    for (const char* shell : {"bash", "zsh"}) {  // zsh's is bash's behind bashcompinit
        const auto script = runMetier({"completion", shell});
        EXPECT_EQ(script.status, kSuccess);
        for (const auto& command : kCommands) {
            EXPECT_THAT(script.output, HasSubstr(command));
        }
        const CellFile file(script.output);
        auto checked =
            link::ChildProcess::start({"bash", "-n", file.name()}, link::ErrorOutput::with_output);
        ASSERT_TRUE(checked);
        EXPECT_EQ(checked->waitUntil(inAMinute()), 0)
            << checked->readLine(inAMinute()).value_or("");
    }
}

TEST(Cli, FishScriptClosesItsQuotes) {
    std::istringstream script(runMetier({"completion", "fish"}).output);
    std::string line;
    while (std::getline(script, line)) {
        std::size_t quotes = 0;
        for (std::size_t i = 0; i < line.size(); ++i) {
            i += line[i] == '\\' ? 1 : 0;
            quotes += i < line.size() && line[i] == '\'' && (i == 0 || line[i - 1] != '\\') ? 1 : 0;
        }
        EXPECT_EQ(quotes % 2, 0U) << line;
    }
}

TEST(Cli, BashCompletesCommandsAndOptions) {
    const CellFile file(runMetier({"completion", "bash"}).output);
    const auto complete = [&](const std::string& words, const std::string& index) {
        auto shell = link::ChildProcess::start({"bash", "-c",
                                                "source " + file.name() + "; COMP_WORDS=(" + words +
                                                    "); COMP_CWORD=" + index +
                                                    "; _metier; echo \"${COMPREPLY[*]}\""});
        return shell->readLine(inAMinute()).value_or("");
    };
    EXPECT_EQ(complete("metier sq", "1"), "square");
    EXPECT_EQ(complete("metier square --sv", "2"), "--svg");
    EXPECT_EQ(complete("metier robot imp", "2"), "import");
    EXPECT_EQ(complete("metier robot import --sr", "3"), "--srdf");
}

/// A cell file that is wrong, and what is said about it behind its name.
struct WrongCell {
    const char* name;
    const char* text;
    std::vector<std::string> parts;
};

void PrintTo(const WrongCell& cell, std::ostream* out) {
    *out << cell.name;
}

class BadCell : public ::testing::TestWithParam<WrongCell> {};

TEST_P(BadCell, IsToldWithFileLineAndKey) {
    const CellFile file(GetParam().text);
    for (const auto& line : std::vector<std::vector<std::string>>{
             {"up", file.name()}, {"serve", file.name()}, {"list", "--cell", file.name()}}) {
        const auto refused = runMetier(line);
        EXPECT_EQ(refused.status, kUsage) << refused.output;
        for (const auto& part : GetParam().parts) {
            EXPECT_THAT(refused.output, HasSubstr(file.name() + part));
        }
    }
}

INSTANTIATE_TEST_SUITE_P(
    Cells, BadCell,
    ::testing::Values(
        WrongCell{"UnknownKey",
                  "name = \"a\"\n[[server]]\nname = \"b\"\nkind = \"move\"\nrobot = "
                  "\"opc.tcp://x:1\"\nprot = 1\n",
                  {":6: server[0].prot: unknown key"}},
        WrongCell{"UnknownKind",
                  "name = \"a\"\n[[server]]\nname = \"b\"\nkind = \"dog\"\n",
                  {":4: server[0].kind: \"dog\" is not one of: arm, gripper, move"}},
        WrongCell{"PortOutOfRange",
                  "name = \"a\"\n[[server]]\nname = \"b\"\nport = 99999\nkind = \"move\"\nrobot = "
                  "\"opc.tcp://x:1\"\n",
                  {":4: server[0].port: 99999"}},
        WrongCell{"ModelThatIsNotThere",
                  "name = \"a\"\n[[server]]\nname = \"b\"\nkind = \"arm\"\nmodel = "
                  "\"none.toml\"\nnodeset = \"iiwa\"\nskills = []\n",
                  {":5: server[0].model: no such file: "}},
        WrongCell{"TwoErrorsAtOnce",
                  "name = \"a\"\n[[server]]\nname = 7\nkind = \"dog\"\n",
                  {":3: server[0].name: ", ":4: server[0].kind: "}},
        WrongCell{"NoToml", "name = = 1\n", {":1"}}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(Cli, ACellFileThatIsNotThereIsUsageAndNamed) {
    const auto refused = runMetier({"up", "/nonexistent/cell.toml"});
    EXPECT_EQ(refused.status, kUsage);
    EXPECT_THAT(refused.output, HasSubstr("/nonexistent/cell.toml"));
}

TEST(Cli, AServerThatTheCellLacksIsUsageWithTheNamesThereAre) {
    const auto refused = runMetier({"serve", demoCell().string(), "--server", "ur6"});
    EXPECT_EQ(refused.status, kUsage);
    EXPECT_THAT(refused.output,
                AllOf(HasSubstr("no server 'ur6'"), HasSubstr("ur5, ur5-move, iiwa")));
}

/// Commands to one robot's server.
class CliOnARobot : public ::testing::Test {
protected:
    static void SetUpTestSuite() { server_ = std::make_unique<ServerProcess>("iiwa"); }
    static void TearDownTestSuite() { server_.reset(); }

    static Finished run(std::vector<std::string> rest, Errors errors = Errors::with_output) {
        rest.insert(rest.begin(), {"run", server_->url()});
        return runMetier(rest, errors);
    }

    // Owned by the suite: a server takes a moment to start.
    static inline std::unique_ptr<ServerProcess> server_;
};

TEST_F(CliOnARobot, ListShowsItsSkillsAndTheirStates) {
    const auto list = runMetier({"list", server_->url()});
    EXPECT_EQ(list.status, kSuccess);
    EXPECT_THAT(list.output, HasSubstr(server_->url()));
    EXPECT_THAT(list.output, ::testing::ContainsRegex("JointPtpMoveSkill +Ready"));
}

TEST_F(CliOnARobot, ListAsJsonIsParsed) {
    const auto list = runMetier({"list", "--json", server_->url()}, Errors::left_out);
    EXPECT_EQ(list.status, kSuccess);
    const auto json = nlohmann::json::parse(list.output);
    ASSERT_THAT(json[0].at("skills"), SizeIs(4));
    EXPECT_EQ(json[0].at("skills")[0].at("state"), "Ready");
}

TEST_F(CliOnARobot, RunShowsTheFieldsOfASkill) {
    const auto fields = run({"JointPtpMoveSkill", "--fields"});
    EXPECT_EQ(fields.status, kSuccess);
    EXPECT_THAT(fields.output, ::testing::ContainsRegex("TargetJointPosition +number,number"));
    EXPECT_THAT(fields.output, ::testing::ContainsRegex("MaxVelocity +[^\n]* rad/s "));
}

TEST_F(CliOnARobot, RunMovesAndPrintsTheResultAsJson) {
    const auto moved = run({"JointPtpMoveSkill", "--json", "--set", "Relative=1", "--set",
                            "TargetJointPosition=0,0,0,0,0,0,0.1"},
                           Errors::left_out);
    EXPECT_EQ(moved.status, kSuccess);
    const auto json = nlohmann::json::parse(moved.output);
    EXPECT_TRUE(json.contains("ReachedJointPosition")) << json.dump(2);
}

TEST_F(CliOnARobot, AnUnknownSkillIsAFailureWithTheNamesThereAre) {
    const auto refused = run({"DanceSkill"});
    EXPECT_EQ(refused.status, kFailed);
    EXPECT_THAT(refused.output,
                AllOf(HasSubstr("no skill 'DanceSkill'"), HasSubstr("JointPtpMoveSkill")));
}

TEST_F(CliOnARobot, AnUnknownParameterIsUsage) {
    const auto refused = run({"JointPtpMoveSkill", "--set", "Target=1"});
    EXPECT_EQ(refused.status, kUsage);
    EXPECT_THAT(refused.output, AllOf(HasSubstr("JointPtpMoveSkill has no parameter 'Target'"),
                                      HasSubstr("--fields")));
}

TEST_F(CliOnARobot, AValueThatIsNotWrittenAsItsTypeIsUsage) {
    const auto refused = run({"JointPtpMoveSkill", "--set", "SpeedOverride=50%"});
    EXPECT_EQ(refused.status, kUsage);
    EXPECT_THAT(refused.output, HasSubstr("SpeedOverride: '50%' is not written as number"));
}

TEST_F(CliOnARobot, AValueOverItsLimitIsAFailureWithValueLimitAndUnit) {
    const auto refused = run({"JointPtpMoveSkill", "--set", "MaxVelocity=25,1,1,1,1,1,1"});
    EXPECT_EQ(refused.status, kFailed);
    EXPECT_THAT(refused.output, AllOf(HasSubstr("BadOutOfRange"),
                                      HasSubstr("25 rad/s is over the limit 20 rad/s")));
}

TEST_F(CliOnARobot, HaltHaltsEverySkillAndIsDoneASecondTimeToo) {
    const ServerProcess own("iiwa");
    for (const char* word : {" halted", " is halted"}) {
        const auto halted = runMetier({"halt", own.url()});
        EXPECT_EQ(halted.status, kSuccess) << halted.output;
        EXPECT_THAT(halted.output, HasSubstr(word));
    }
    EXPECT_THAT(runMetier({"list", own.url()}).output, Not(HasSubstr("Ready")));
}

TEST_F(CliOnARobot, ARunOfWhatIsHaltedSaysWhyItIsHaltedAndWhatToDo) {
    const ServerProcess own("iiwa");
    EXPECT_EQ(runMetier({"halt", own.url()}).status, kSuccess);
    const std::vector<std::string> run{"run", own.url(), "JointPtpMoveSkill", "--set",
                                       "TargetJointPosition=0,0,0,0,0,0,0.1"};
    const auto refused = runMetier(run);
    EXPECT_EQ(refused.status, kFailed);
    EXPECT_THAT(refused.output,
                AllOf(HasSubstr("Halted (ByClient"),
                      HasSubstr("metier reset " + own.url() + " JointPtpMoveSkill")));
    EXPECT_EQ(runMetier({"reset", own.url(), "JointPtpMoveSkill"}).status, kSuccess);
    EXPECT_EQ(runMetier(run).status, kSuccess);
}

}  // namespace
}  // namespace metier::system_tests
