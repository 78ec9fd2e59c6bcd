// Composed skills three levels deep, over the processes of an arm and of two components.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <fstream>
#include <optional>

#include "metier_program.hpp"
#include "watched_skill.hpp"

namespace metier::system_tests {
namespace {

using namespace std::chrono_literals;
using skill::Reason;
using skill::State;
using skill::TransitionEvent;
using skill::ValueMap;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::MatchesRegex;

std::filesystem::path composedCell() {
    return std::filesystem::path(METIER_SOURCE_DIR) / "tests" / "system" / "composed.toml";
}

ServerProcess serve(const std::string& name, std::vector<std::string> more = {},
                    const std::string& port = "0") {
    more.insert(more.end(), {"--port", port});
    return ServerProcess(name, more, composedCell());
}

class ComposedArm : public ::testing::Test {
protected:
    /// \param swing which of the servers of SwingSkill
    explicit ComposedArm(std::string swing = "swing") : swing_name_(std::move(swing)) {
        home_ = jointPosition(arm_->client(), **arm_);
        away_ = home_;
        away_.front() += 0.2;
    }

    ServerProcess serveSwing(const std::string& port) {
        return serve(swing_name_, {"--use", "iiwa=" + arm_server_.url()}, port);
    }

    ValueMap parameters(double speed) const {
        return {{"Home", home_}, {"Away", away_}, {"Speed", speed}};
    }
    /// A move of half a minute; the arm runs.
    void startSlowly() {
        away_.front() = home_.front() + 1.0;
        const auto started = (*wave_)->startWith({"slow", parameters(0.02)});
        ASSERT_TRUE(started) << started.error().message;
        arm_->awaitEvent(State::running);
    }

    std::string swing_name_;
    ServerProcess arm_server_ = serve("iiwa", {}, lastingPort());
    std::optional<ServerProcess> swing_server_ = serveSwing(lastingPort());
    ServerProcess wave_server_ = serve("wave", {"--use", "swing=" + swing_server_->url()});
    std::optional<Watched> arm_{std::in_place, arm_server_.url(), "JointPtpMoveSkill"};
    std::optional<Watched> swing_{std::in_place, swing_server_->url(), "SwingSkill"};
    std::optional<Watched> wave_{std::in_place, wave_server_.url(), "WaveSkill"};
    std::vector<double> home_;
    std::vector<double> away_;
};

TEST_F(ComposedArm, MovesThroughThreeLevels) {
    const auto result = (*wave_)->runWith({"wave", parameters(1.0)}, inAMinute());
    ASSERT_TRUE(result) << result.error().message;
    for (int move = 0; move < 4; ++move) {
        const auto begun = arm_->awaitEvent(State::running);
        EXPECT_THAT(
            begun.execution_id,
            MatchesRegex(
                "swing.SwingSkill~.*/wave.ThereAndBackSkill~.*/wave.WaveSkill~.*/wave/wave/.*"
                "/swing/1"));
        EXPECT_EQ(arm_->awaitEvent(State::ready).reason, Reason::finished);
    }
    EXPECT_NEAR(jointPosition(arm_->client(), **arm_).front(), home_.front(), 1e-3);
}

TEST_F(ComposedArm, RefusesWhatIsWrongInTheWordsOfTheArm) {
    away_.front() = 20.0;
    const auto result = (*wave_)->runWith({"wrong", parameters(1.0)}, inAMinute());
    ASSERT_FALSE(result);
    EXPECT_THAT(result.error().message,
                HasSubstr("step there: SwingSkill of swing was Halted (Error): step swing: "
                          "JointPtpMoveSkill of iiwa refused Start: "));
    EXPECT_THAT(result.error().message, HasSubstr("rad"));
}

TEST_F(ComposedArm, IsSuspendedResumedAndHaltedDownToTheArm) {
    startSlowly();
    ASSERT_TRUE((*wave_)->suspend());
    const auto arm_rests = arm_->awaitEvent(State::suspended);
    const auto all_rests = wave_->awaitEvent(State::suspended);
    EXPECT_LE(arm_rests.time, all_rests.time) << "Suspended means that the arm stands still";
    const auto rest = jointPosition(arm_->client(), **arm_);
    EXPECT_LT(rest.front(), away_.front());
    ASSERT_TRUE((*wave_)->resume());
    arm_->awaitEvent(State::running);
    ASSERT_TRUE((*wave_)->halt());
    const auto arm_stands = arm_->awaitEvent(State::halted);
    const auto all_stands = wave_->awaitEvent(State::halted);
    EXPECT_LE(arm_stands.time, all_stands.time);
    EXPECT_EQ(all_stands.reason, Reason::by_client);
    ASSERT_TRUE((*wave_)->reset());
    away_.front() = home_.front() + 0.05;
    const auto again = (*wave_)->runWith({"again", parameters(1.0)}, inAMinute());
    EXPECT_TRUE(again) << "what was halted from here is reset from here: " << again.error().message;
}

TEST_F(ComposedArm, IsSuspendedIfSomebodySuspendsTheArmAndGoesOnAsAWhole) {
    startSlowly();
    ASSERT_TRUE((*arm_)->suspend());
    const auto arm_rests = arm_->awaitEvent(State::suspended);
    const auto between = swing_->awaitEvent(State::suspended);
    const auto whole = wave_->awaitEvent(State::suspended);
    EXPECT_LE(arm_rests.time, between.time);
    EXPECT_LE(between.time, whole.time);
    EXPECT_EQ(whole.reason, Reason::by_client);
    EXPECT_THAT(whole.reason_text, HasSubstr("JointPtpMoveSkill of iiwa was suspended by metier"));
    const auto read = (*wave_)->reasonText();
    EXPECT_EQ(read, whole.reason_text) << "also for those who ask later";
    ASSERT_TRUE((*wave_)->resume());
    arm_->awaitEvent(State::running);
    wave_->awaitEvent(State::running);
    ASSERT_TRUE((*wave_)->halt());
    EXPECT_EQ(wave_->awaitEvent(State::halted).reason, Reason::by_client);
}

TEST_F(ComposedArm, EndsIfSomebodyHaltsTheArm) {
    startSlowly();
    ASSERT_TRUE((*arm_)->halt());
    const auto halted = wave_->awaitEvent(State::halted);
    EXPECT_EQ(halted.reason, Reason::error);
    EXPECT_THAT(halted.reason_text, HasSubstr("JointPtpMoveSkill of iiwa was Halted (ByClient)"));
    ASSERT_TRUE((*wave_)->reset());
    const auto again = (*wave_)->runWith({"again", parameters(1.0)}, inAMinute());
    ASSERT_FALSE(again) << "a person has halted the arm, and nobody has reset it";
    EXPECT_THAT(again.error().message, HasSubstr("JointPtpMoveSkill of iiwa (arm) is Halted"));
}

TEST_F(ComposedArm, EndsIfTheArmsServerDies) {
    startSlowly();
    arm_server_.kill();
    const auto halted = wave_->awaitEvent(State::halted);
    EXPECT_EQ(halted.reason, Reason::device_lost);
    EXPECT_THAT(halted.reason_text, HasSubstr("step waves[1]/wave: ThereAndBackSkill"));
    EXPECT_THAT(halted.reason_text, HasSubstr("JointPtpMoveSkill of iiwa is lost"));
}

TEST_F(ComposedArm, GoesOnOnceTheArmsServerIsBack) {
    startSlowly();
    arm_server_.kill();
    wave_->awaitEvent(State::halted);
    arm_.reset();
    arm_server_ = serve("iiwa", {}, arm_server_.port());
    arm_.emplace(arm_server_.url(), "JointPtpMoveSkill");
    home_ = jointPosition(arm_->client(), **arm_);
    away_ = home_;
    away_.front() += 0.05;
    // Each Start is refused with that until its component has connected again.
    const auto deadline = inAMinute();
    for (int attempt = 1;; ++attempt) {
        if (const auto state = (*wave_)->state(); state == State::halted) {
            ASSERT_TRUE((*wave_)->reset());
        }
        const auto result =
            (*wave_)->runWith({fmt::format("again-{}", attempt), parameters(1.0)}, inAMinute());
        if (result) {
            break;
        }
        ASSERT_THAT(result.error().message, HasSubstr("reach")) << result.error().message;
        ASSERT_LT(std::chrono::steady_clock::now(), deadline);
    }
}

TEST_F(ComposedArm, EndsIfTheComponentBetweenDies) {
    startSlowly();
    swing_server_->kill();
    const auto halted = wave_->awaitEvent(State::halted);
    EXPECT_EQ(halted.reason, Reason::device_lost);
    EXPECT_THAT(halted.reason_text, HasSubstr("SwingSkill of swing is lost"));
    const auto arm = arm_->awaitEvent(State::halted);
    EXPECT_EQ(arm.reason, Reason::owner_lost) << "its server misses the session that commanded it";
}

class StubbornArm : public ComposedArm {
protected:
    StubbornArm() : ComposedArm("stubborn-swing") {}
};

TEST_F(StubbornArm, IsHaltedByItsComponentThatWasStartedAgain) {
    startSlowly();
    swing_server_->kill();
    wave_->awaitEvent(State::halted);
    EXPECT_EQ((*arm_)->state(), State::running) << "the file says so";
    swing_.reset();
    swing_server_ = serveSwing(swing_server_->port());
    const auto halted = arm_->awaitEvent(State::halted);
    EXPECT_EQ(halted.reason, Reason::by_client);
}

TEST_F(ComposedArm, ShowsWhatItIsMadeOfAndWhereItIs) {
    startSlowly();
    auto& client = wave_->client();
    const auto metier = client.namespaceIndex("urn:metier:skills").value();
    const auto& node = (*wave_)->address().node;
    EXPECT_EQ((*wave_)->address().type_name, "WaveSkillType");
    const auto uses = client.browse({.node = node, .reference_type = {metier, 20306U}}).value();
    ASSERT_EQ(uses.size(), 1U);
    EXPECT_EQ(uses.front().browse_name.name, "ThereAndBackSkill");
    const auto read = [&](const std::string& name) {
        return client.read(client.translate(node, {{metier, name}}).value()).value();
    };
    EXPECT_EQ(read("CurrentStep").as<std::string>(), "waves[1]/wave");
    EXPECT_THAT(read("Steps").as<std::vector<std::string>>().value(), ElementsAre("waves", "wave"));
    EXPECT_EQ(read("ExecutionId").as<std::string>(), "slow");
    EXPECT_LT(read("Progress").as<double>().value(), 0.5);

    auto& between = swing_->client();
    const auto index = between.namespaceIndex("urn:metier:skills").value();
    const auto used =
        between.browse({.node = (*swing_)->address().node, .reference_type = {index, 20306U}})
            .value();
    ASSERT_EQ(used.size(), 1U);
    const auto url =
        between.read(between.translate(used.front().target, {{index, "EndpointUrl"}}).value());
    EXPECT_EQ(url.value().as<std::string>(), arm_server_.url());
}

TEST(ArmsOwnComposition, RefusesWishesThatNobodyLooksAt) {
    const auto folder = std::filesystem::path(::testing::TempDir()) / "own_composition";
    std::filesystem::create_directories(folder);
    const auto model = std::filesystem::path(METIER_SOURCE_DIR) / "models" / "iiwa7.toml";
    std::ofstream(folder / "cell.toml") << fmt::format(R"(name = "cell"
[[server]]
name = "arm"
kind = "arm"
driver = {{ type = "simulator" }}
model = "{}"
skills = ["JointPtpMoveSkill"]
compositions = ["own.toml"]
)",
                                                       model.string());
    for (const auto* wish :
         {"server = \"other\"", "controller = \"Arm\"", "reach = 9.0", "payload = 1.0"}) {
        std::ofstream(folder / "own.toml") << fmt::format(R"(name = "OwnSkill"
[uses.arm]
type = "JointPtpMoveSkillType"
{}
[[step]]
name = "move"
run = "arm"
with.TargetJointPosition = [0, 0, 0, 0, 0, 0, 0]
)",
                                                          wish);
        const auto refused = runMetier({"serve", (folder / "cell.toml").string()});
        EXPECT_NE(refused.status, 0) << wish;
        EXPECT_THAT(refused.output, HasSubstr("own.toml:2: uses.arm: ")) << wish;
    }
}

TEST(CompositionServer, RefusesWishesForASkillOfItsOwn) {
    // They were not looked at.
    const auto folder = std::filesystem::path(::testing::TempDir()) / "own_wishes";
    std::filesystem::create_directories(folder);
    std::ofstream(folder / "inner.toml") << R"(name = "InnerSkill"
[uses.arm]
type = "JointPtpMoveSkillType"
[[step]]
name = "move"
run = "arm"
)";
    std::ofstream(folder / "outer.toml") << R"(name = "OuterSkill"
[uses.inner]
type = "InnerSkillType"
reach = 9.0
[[step]]
name = "once"
run = "inner"
)";
    std::ofstream(folder / "cell.toml") << R"(name = "cell"
[[server]]
name = "both"
kind = "composition"
compositions = ["inner.toml", "outer.toml"]
servers = ["opc.tcp://127.0.0.1:1"]
)";
    const auto arm = serve("iiwa");
    const auto refused = runMetier({"serve", (folder / "cell.toml").string(), "--port", "0",
                                    "--use", "opc.tcp://127.0.0.1:1=" + arm.url()});
    EXPECT_NE(refused.status, 0);
    EXPECT_THAT(refused.output, HasSubstr("outer.toml:2: uses.inner: controller, reach and "
                                          "payload choose among skills of other servers"));
}

TEST(CompositionServer, TellsWhatIsWrongWithItsFilesBeforeAnythingStarts) {
    const auto folder = std::filesystem::path(::testing::TempDir()) / "wrong_composition";
    std::filesystem::create_directories(folder);
    std::ofstream(folder / "wrong.toml") << R"(name = "WrongSkill"
[uses.arm]
type = "JointPtpMoveSkillType"
[[step]]
name = "move"
run = "arm"
with.TargetJointPosition = "there"
with.Speed = 1
)";
    std::ofstream(folder / "cell.toml") << R"(name = "cell"
[[server]]
name = "wrong"
kind = "composition"
compositions = ["wrong.toml"]
servers = ["opc.tcp://127.0.0.1:1"]
)";
    const auto unreachable = runMetier({"serve", (folder / "cell.toml").string()});
    EXPECT_NE(unreachable.status, 0);
    EXPECT_THAT(unreachable.output, HasSubstr("opc.tcp://127.0.0.1:1"));

    const auto arm = serve("iiwa");
    const auto wrong = runMetier(
        {"serve", (folder / "cell.toml").string(), "--use", "opc.tcp://127.0.0.1:1=" + arm.url()});
    EXPECT_NE(wrong.status, 0);
    EXPECT_THAT(wrong.output,
                HasSubstr("wrong.toml:7: step[0].with.TargetJointPosition: is not a list of "
                          "numbers"));
    EXPECT_THAT(wrong.output,
                HasSubstr("wrong.toml:8: step[0].with.Speed: JointPtpMoveSkill has no such "
                          "parameter"));
}

TEST(GuideToCompositions, ShowsTheFilesThatRunHere) {
    const auto guide = sourceText("docs/guide/compose.md");
    EXPECT_THAT(guide, HasSubstr("```toml\n" + sourceText("compositions/visit.toml") + "```"));
    EXPECT_THAT(guide, HasSubstr("```toml\n" + sourceText("cells/visit.toml") + "```"));
    const auto cell = std::filesystem::path(METIER_SOURCE_DIR) / "cells" / "visit.toml";
    // The file has the limits of a machine that does little else: one run of some keeps them.
    Finished run;
    for (int attempt = 0; attempt < 3 && run.status != 0; ++attempt) {
        const ServerProcess arm("iiwa", {"--port", "0"}, cell);
        const ServerProcess visit("visit", {"--port", "0", "--use", "iiwa=" + arm.url()}, cell);
        run = runMetier({"run", visit.url(), "VisitSkill", "--set",
                         "Pose=0.5,0,0.4,3.14159,0,3.14159", "--set", "Approach=0.1"});
    }
    EXPECT_EQ(run.status, 0) << run.output;
    EXPECT_THAT(run.output, HasSubstr("Deviation"));
}

TEST(VisitSkill, ArrivesInAJointPositionFromWhichItsLineIsPossible) {
    const auto cell = std::filesystem::path(METIER_SOURCE_DIR) / "cells" / "visit.toml";
    const ServerProcess arm("iiwa", {"--port", "0"}, cell);
    const ServerProcess visit("visit", {"--port", "0", "--use", "iiwa=" + arm.url()}, cell);
    const std::string pose = "-0.442,-0.077,0.174,3.461,0.005,2.92";
    const std::string above = "-0.442,-0.077,0.474,3.461,0.005,2.92";
    const auto nearest =
        runMetier({"run", arm.url(), "CartesianPtpMoveSkill", "--set", "TargetPosition=" + above});
    ASSERT_EQ(nearest.status, 0) << nearest.output;
    const auto line = runMetier(
        {"run", arm.url(), "CartesianLinearMoveSkill", "--set", "TargetPosition=" + pose});
    EXPECT_NE(line.status, 0) << "impossible from where a PTP alone arrives";
    const auto visited = runMetier(
        {"run", visit.url(), "VisitSkill", "--set", "Pose=" + pose, "--set", "Approach=0.3"});
    EXPECT_EQ(visited.status, 0) << visited.output;
}

TEST(Graph, IsDrawnAsTextAndTellsWhatSvgNeeds) {
    const auto file =
        std::filesystem::path(METIER_SOURCE_DIR) / "compositions" / "pick_and_place.toml";
    const auto dot = runMetier({"graph", file.string()});
    EXPECT_EQ(dot.status, 0);
    EXPECT_THAT(dot.output, HasSubstr("\"down_to_pick\" [label=\"down_to_pick — "
                                      "CartesianLinearMoveSkillType\"];"));
    const auto svg = runMetier({"graph", file.string(), "--format", "svg"});
    if (svg.status == 0) {
        EXPECT_THAT(svg.output, HasSubstr("<svg"));
    } else {
        EXPECT_THAT(svg.output, HasSubstr("svg needs Graphviz"));
    }
}

TEST(Graph, OfAServerIsThatOfTheFileThatItsSkillWasMadeOf) {
    const ServerProcess arm = serve("iiwa");
    const ServerProcess swing = serve("swing", {"--use", "iiwa=" + arm.url()});
    const auto drawn = runMetier({"graph", swing.url()});
    EXPECT_EQ(drawn.status, 0) << drawn.output;
    const auto file =
        std::filesystem::path(METIER_SOURCE_DIR) / "tests" / "system" / "compositions";
    EXPECT_EQ(drawn.output, runMetier({"graph", (file / "swing.toml").string()}).output);
    EXPECT_EQ(runMetier({"graph", swing.url(), "SwingSkill"}).output, drawn.output);

    const auto wrong = runMetier({"graph", swing.url(), "WaveSkill"});
    EXPECT_EQ(wrong.status, 2);
    EXPECT_THAT(wrong.output,
                HasSubstr("no composed skill WaveSkill; its composed skills: SwingSkill"));
    const auto none = runMetier({"graph", arm.url()});
    EXPECT_EQ(none.status, 2);
    EXPECT_THAT(none.output, HasSubstr("none of its skills says what it is made of"));
}

}  // namespace
}  // namespace metier::system_tests
