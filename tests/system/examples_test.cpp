// The programs of examples/01_skill to 04_composition, as docs/guide/first-skill.md shows them.
#include <gmock/gmock.h>

#include <filesystem>
#include <string>
#include <vector>

#include "installation.hpp"
#include "metier/link/child_process.hpp"
#include "metier_program.hpp"
#include "watched_skill.hpp"

namespace metier::system_tests {
namespace {

using skill::State;
using ::testing::AllOf;
using ::testing::HasSubstr;

using Command = std::vector<std::string>;

/// An example's server, on a free port.
Command laboratory(const std::string& program) {
    return {program, "--insecure-lab", "--port", "0"};
}

/// examples/03_client, with its arguments.
Command runSkill(const Command& arguments) {
    Command command{METIER_EXAMPLE_RUN_SKILL};
    command.insert(command.end(), arguments.begin(), arguments.end());
    return command;
}

Finished client(const Command& arguments) {
    return runToEnd(runSkill(arguments));
}

std::filesystem::path presentCell() {
    return std::filesystem::path(METIER_SOURCE_DIR) / "examples" / "04_composition" / "cell.toml";
}

TEST(FirstSkill, IsListedAndRunByItsName) {
    const ServerProcess lamp(laboratory(METIER_EXAMPLE_LAMP));
    EXPECT_THAT(runMetier({"list", lamp.url()}).output,
                AllOf(HasSubstr("lamp"), HasSubstr("ToggleLampSkill"), HasSubstr("Ready")));
    const Command run{"run", lamp.url(), "ToggleLampSkill", "--json"};
    for (const auto* lit : {"true", "false", "true"}) {
        const auto ended = runMetier(run);
        EXPECT_EQ(ended.status, 0) << ended.output;
        EXPECT_THAT(ended.output, HasSubstr(std::string("\"Lit\": ") + lit));
    }
}

TEST(FirstSkill, ShowsWhatItDoesBehindItsReadyLine) {
    auto lamp = link::ChildProcess::start(laboratory(METIER_EXAMPLE_LAMP)).value();
    const auto ready = lamp.readLine(inAMinute()).value();
    ASSERT_TRUE(ready.starts_with("ready opc.tcp://127.0.0.1:")) << ready;
    const auto url = ready.substr(ready.find(' ') + 1);
    EXPECT_EQ(client({url, "ToggleLampSkill", "60"}).status, 0);
    EXPECT_EQ(lamp.readLine(inAMinute()).value_or(""), "the lamp is on");
    lamp.signal(SIGINT);
    EXPECT_EQ(lamp.waitUntil(inAMinute()), 0);
}

TEST(FirstSkill, IsClosedUnlessItIsALab) {
    const Installation here("here");
    const ServerProcess lamp(
        Command{METIER_EXAMPLE_LAMP, "--port", "0", "--security", here.folder().string()});
    const auto refused = runMetier({"list", lamp.url()});
    EXPECT_EQ(refused.status, 1);
    EXPECT_THAT(refused.output, HasSubstr("leave out --insecure-lab"));
    const auto ended = here.run({"run", lamp.url(), "ToggleLampSkill"});
    EXPECT_EQ(ended.status, 0) << ended.output;
}

TEST(FirstSkill, KeepsRecordsAndNamesWhereItIsTold) {
    const Installation here("here");
    const auto state = here.folder() / "state";
    std::filesystem::create_directories(state);
    auto command = laboratory(METIER_EXAMPLE_LAMP);
    command.insert(command.end(), {"--state", state.string()});
    const ServerProcess lamp(command);
    ASSERT_EQ(runMetier({"run", lamp.url(), "ToggleLampSkill"}).status, 0);
    EXPECT_TRUE(std::filesystem::exists(state / "records.db"));
}

TEST(FirstSkill, SaysThatItsPortIsTaken) {
    const ServerProcess lamp(laboratory(METIER_EXAMPLE_LAMP));
    const auto second = runToEnd({METIER_EXAMPLE_LAMP, "--insecure-lab", "--port", lamp.port()});
    EXPECT_EQ(second.status, 1) << second.output;
    EXPECT_THAT(second.output, AllOf(HasSubstr("lamp: "), HasSubstr(lamp.port())));
}

TEST(FirstSkill, IsInTheGuideAsItIsBuilt) {
    EXPECT_THAT(sourceText("docs/guide/first-skill.md"),
                HasSubstr(sourceText("examples/01_skill/lamp.cpp")));
    EXPECT_THAT(sourceText("docs/guide/first-skill.md"),
                HasSubstr(sourceText("examples/01_skill/CMakeLists.txt")));
}

class Turntable : public ::testing::Test {
protected:
    ServerProcess table_{laboratory(METIER_EXAMPLE_TURNTABLE)};
};

TEST_F(Turntable, TurnsAndReportsWhereItStands) {
    Watched turn(table_.url(), "TurnTableSkill");
    for (const double stands : {1.5, 3.0}) {
        const auto result = turn->runWith({"", {{"Angle", 1.5}, {"Speed", 2.0}}}, inAMinute());
        ASSERT_TRUE(result) << result.error().message;
        EXPECT_DOUBLE_EQ(std::get<double>(result->at("TableAngle")), stands);
        EXPECT_EQ(turn.awaitEvent(State::ready).intermediate_result, skill::Value(stands));
    }
}

TEST_F(Turntable, RefusesWhatItsFieldsAndItsCableDoNotAllow) {
    const auto connection = connectTo(table_.url());
    auto turn = openSkill(*connection, "TurnTableSkill");
    const auto fast = turn.startWith({"", {{"Angle", 1.0}, {"Speed", 3.0}}});
    ASSERT_FALSE(fast);
    EXPECT_THAT(fast.error().message, HasSubstr("3 rad/s is over the limit 2 rad/s"));
    EXPECT_FALSE(turn.startWith({"", {}})) << "it needs no angle";

    ASSERT_TRUE(turn.runWith({"", {{"Angle", 4.0}, {"Speed", 2.0}}}, inAMinute()));
    const auto far = turn.startWith({"", {{"Angle", 4.0}}});
    ASSERT_FALSE(far);
    EXPECT_THAT(far.error().message,
                HasSubstr("the table would stand at 8.00 rad, and its cable ends at 6.28 rad"));
    const auto checked = turn.check({{"Angle", -2.0}});
    ASSERT_TRUE(checked) << checked.error().message;
    EXPECT_TRUE(checked->possible) << checked->reason;
    EXPECT_DOUBLE_EQ(checked->planned_duration, 4.0);
}

TEST_F(Turntable, StandsWhileItIsSuspendedAndStopsWhereItIsHalted) {
    Watched turn(table_.url(), "TurnTableSkill");
    ASSERT_TRUE(turn->startWith({"", {{"Angle", 6.0}, {"Speed", 0.01}}}));
    turn.awaitEvent(State::running);
    ASSERT_TRUE(turn->suspend());
    const auto rest = turn.awaitEvent(State::suspended).intermediate_result;
    ASSERT_TRUE(turn->resume());
    turn.awaitEvent(State::running);
    ASSERT_TRUE(turn->halt());
    const auto halted = turn.awaitEvent(State::halted);
    EXPECT_EQ(halted.reason, skill::Reason::by_client);
    ASSERT_TRUE(turn->reset());
    const auto back = turn->runWith({"", {{"Angle", 0.0}}}, inAMinute());
    ASSERT_TRUE(back) << back.error().message;
    const double stands = std::get<double>(back->at("TableAngle"));
    EXPECT_LT(stands, 6.0) << "it went on to the end";
    const auto* const rested = std::get_if<double>(&rest);
    EXPECT_GE(stands, rested == nullptr ? 0.0 : *rested) << "it jumped back";
}

TEST_F(Turntable, HasATypeInItsOwnNamespaceAndIsFoundByItsTask) {
    const auto connection = connectTo(table_.url());
    EXPECT_TRUE(connection->namespaceIndex("urn:example:turntable"));
    const auto found = runMetier({"find", "turn", "--at", table_.url()});
    EXPECT_EQ(found.status, 0) << found.output;
    EXPECT_THAT(found.output, HasSubstr("TurnTableSkill fits"));
}

TEST_F(Turntable, IsTurnedByTheExampleClient) {
    const auto turned = client({table_.url(), "TurnTableSkill", "60", "Angle=0.5", "Speed=2"});
    EXPECT_EQ(turned.status, 0) << turned.output;
    EXPECT_THAT(turned.output, AllOf(HasSubstr("Ready to Running"), HasSubstr("Running to Ready"),
                                     HasSubstr("{\"TableAngle\":0.5}")));
}

TEST_F(Turntable, IsHaltedByTheExampleClientWhenItTakesTooLong) {
    const auto slow = client({table_.url(), "TurnTableSkill", "1", "Angle=6", "Speed=0.01"});
    EXPECT_EQ(slow.status, 1);
    EXPECT_THAT(slow.output, HasSubstr("halted, since it takes too long: it is Halted now"));
    const auto connection = connectTo(table_.url());
    EXPECT_EQ(openSkill(*connection, "TurnTableSkill").state().value(), State::halted);
}

TEST_F(Turntable, IsHaltedByTheExampleClientAtCtrlC) {
    auto running = link::ChildProcess::start(
                       runSkill({table_.url(), "TurnTableSkill", "3600", "Angle=6", "Speed=0.01"}),
                       link::ErrorOutput::with_output)
                       .value();
    Watched turn(table_.url(), "TurnTableSkill");
    ASSERT_TRUE(turn->awaitState(State::running, inAMinute()));
    running.signal(SIGINT);
    EXPECT_EQ(running.waitUntil(inAMinute()), 1);
    EXPECT_EQ(turn->state().value(), State::halted);
}

TEST_F(Turntable, MakesTheExampleClientReportWhatIsWrong) {
    const auto url = table_.url();
    const auto said = [&](const Command& arguments) { return client(arguments).output; };
    EXPECT_THAT(said({url, "TurnSkill", "10"}), HasSubstr("TurnTableSkill"));
    EXPECT_THAT(said({url, "TurnTableSkill", "10", "Angel=1"}),
                HasSubstr("TurnTableSkill has no parameter 'Angel'"));
    EXPECT_THAT(said({url, "TurnTableSkill", "10", "Angle=fast"}),
                HasSubstr("Angle: 'fast' is no JSON value"));
    EXPECT_THAT(said({url, "TurnTableSkill", "10", "Angle=\"1\""}), HasSubstr("Angle"));
    EXPECT_THAT(said({url, "TurnTableSkill", "10", "Angle"}), HasSubstr("Angle: ''"));
    EXPECT_THAT(said({url, "TurnTableSkill", "10", ""}), HasSubstr("no parameter ''"));
    EXPECT_THAT(said({url, "TurnTableSkill", "10", "Angle=60"}), HasSubstr("over the limit"));
    const auto soon = client({url, "TurnTableSkill", "soon"});
    EXPECT_EQ(soon.status, 2);
    EXPECT_THAT(soon.output, HasSubstr("'soon' is not a number of seconds"));
    EXPECT_EQ(client({}).status, 2);
    table_.kill();
    EXPECT_EQ(client({url, "TurnTableSkill", "10", "Angle=1"}).status, 1);
}

TEST(ExampleClient, MovesASimulatedArm) {
    const ServerProcess arm("iiwa", {"--port", "0"}, presentCell());
    const auto moved = client({arm.url(), "JointPtpMoveSkill", "120",
                               "TargetJointPosition=[0.2, 0.5, 0, -1.4, 0, 0.9, 0]"});
    EXPECT_EQ(moved.status, 0) << moved.output;
    EXPECT_THAT(moved.output, HasSubstr("Running to Ready"));
}

class PresentedPart : public Turntable {
protected:
    ServerProcess lamp_{laboratory(METIER_EXAMPLE_LAMP)};
    ServerProcess arm_{"iiwa", {"--port", "0"}, presentCell()};
    ServerProcess present_{"present",
                           {"--port", "0", "--use", "iiwa=" + arm_.url(), "--use",
                            "opc.tcp://localhost:48491=" + lamp_.url(), "--use",
                            "opc.tcp://localhost:48492=" + table_.url()},
                           presentCell()};

    /// Whether the lamp is on after it was switched once more.
    bool toggleLamp() {
        const auto connection = connectTo(lamp_.url());
        const auto result = openSkill(*connection, "ToggleLampSkill").run({}, inAMinute());
        return std::get<bool>(result.value().at("Lit"));
    }
};

TEST_F(PresentedPart, LightsTheLampWhileArmAndTableMove) {
    const Command run{"run", present_.url(), "PresentSkill", "--set",
                      "Pose=0.5,0,0.4,3.14159,0,3.14159"};
    const auto first = runMetier(run);
    EXPECT_EQ(first.status, 0) << first.output;
    EXPECT_THAT(first.output, HasSubstr("1.5708"));
    EXPECT_TRUE(toggleLamp()) << "the lamp was left on";
    const auto second = runMetier(run);  // it begins with a lamp that is on
    EXPECT_EQ(second.status, 0) << second.output;
    EXPECT_THAT(second.output, HasSubstr("3.1416"));
    EXPECT_TRUE(toggleLamp()) << "the lamp was left on";
}

TEST_F(PresentedPart, IsHaltedWithTheStepThatTheTableRefuses) {
    for (const char* angle : {"3", "3"}) {
        EXPECT_EQ(
            client({table_.url(), "TurnTableSkill", "60", std::string("Angle=") + angle, "Speed=2"})
                .status,
            0);
    }
    const auto refused = runMetier(
        {"run", present_.url(), "PresentSkill", "--set", "Pose=0.5,0,0.4,3.14159,0,3.14159"});
    EXPECT_EQ(refused.status, 1) << refused.output;
    EXPECT_THAT(refused.output, AllOf(HasSubstr("bring/turn"), HasSubstr("its cable ends at")));
}

}  // namespace
}  // namespace metier::system_tests
