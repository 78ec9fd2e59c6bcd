// Servers and a discovery server in processes of their own.
#include <gmock/gmock.h>

#include <fmt/format.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>

#include "discovered_cell.hpp"

namespace metier::system_tests {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

/// Moves the first axis a little, and expects success.
void moveOn(const std::string& url) {
    const auto client = connectTo(url);
    auto skill = openSkill(*client, "JointPtpMoveSkill");
    auto target = jointPosition(*client, skill);
    target.front() += 0.1;
    const auto moved = skill.run({{"TargetJointPosition", target}}, inAMinute());
    ASSERT_TRUE(moved) << moved.error().message;
    EXPECT_NEAR(jointPosition(*client, skill).front(), target.front(), 1e-3);
}

TEST(DiscoveryOfServers, KnowsAServerFromItsStartToItsEnd) {
    const DiscoveryProcess lds;
    {
        const auto arm = serveDiscovered("iiwa-a", lds.url());
        EXPECT_TRUE(lds.awaitKnown("iiwa-a"));
        const auto servers = opcua::findServers(lds.url()).value();
        for (const auto& server : servers) {
            if (server.application_name.text == "iiwa-a") {
                EXPECT_THAT(server.discovery_urls, ElementsAre(arm.url()));
                EXPECT_THAT(server.application_uri, HasSubstr(":metier:iiwa-a:"));
            }
        }
    }
    EXPECT_THAT(lds.names(), IsEmpty()) << "it has taken itself out before it ended";
}

TEST(DiscoveryOfServers, ForgetsAServerThatWasKilled) {
    const DiscoveryProcess lds(2);
    auto dead = serveDiscovered("iiwa-a", lds.url());
    const auto alive = serveDiscovered("iiwa-b", lds.url());
    ASSERT_TRUE(lds.awaitKnown("iiwa-a"));
    ASSERT_TRUE(lds.awaitKnown("iiwa-b"));
    dead.kill();
    EXPECT_TRUE(lds.awaitForgotten("iiwa-a"));
    EXPECT_TRUE(lds.awaitKnown("iiwa-b")) << "it renews";
}

TEST(DiscoveryOfServers, IsFilledAgainAfterItWasKilledAndStartedAgain) {
    std::optional<DiscoveryProcess> lds(std::in_place, 3'600, lastingPort());
    const auto url = lds->url();
    const auto port = lds->port();
    const auto arm = serveDiscovered("iiwa-a", url);
    ASSERT_TRUE(lds->awaitKnown("iiwa-a"));
    lds->kill();
    moveOn(arm.url());
    lds.emplace(3'600, port);
    EXPECT_TRUE(lds->awaitKnown("iiwa-a"));
}

TEST(DiscoveryOfServers, DoesNotHoldUpStartMotionAndEndOfAServerWhenItHangs) {
    DiscoveryProcess lds;
    lds.signal(SIGSTOP);
    {
        const auto arm = serveDiscovered("iiwa-a", lds.url());  // ready without an answer from it
        moveOn(arm.url());
    }
    const auto next = serveDiscovered("iiwa-b", lds.url());
    moveOn(next.url());
    lds.signal(SIGCONT);
    EXPECT_TRUE(lds.awaitKnown("iiwa-b")) << "registration comes by itself";
}

TEST(DiscoveryOfServers, DoesNotHoldUpAServerWhenItIsNotThere) {
    const auto arm = serveDiscovered("iiwa-a", "opc.tcp://127.0.0.1:1");
    moveOn(arm.url());
}

class Find : public ::testing::Test {
protected:
    Finished find(std::vector<std::string> arguments) const {
        arguments.insert(arguments.begin(), "find");
        arguments.insert(arguments.end(), {"--discovery", lds_.url()});
        return runMetier(arguments);
    }

    DiscoveryProcess lds_;
    ServerProcess strong_ = serveDiscovered("iiwa-a", lds_.url());
    ServerProcess unknown_ = serveDiscovered("iiwa-b", lds_.url());
    bool known_ = lds_.awaitKnown("iiwa-a") && lds_.awaitKnown("iiwa-b");
};

TEST_F(Find, SaysWhatFitsAndWhy) {
    ASSERT_TRUE(known_);
    const auto found = find({"JointPtpMoveSkillType", "--reach", "0.5", "--payload", "5"});
    EXPECT_EQ(found.status, 0);
    EXPECT_THAT(found.output, HasSubstr(strong_.url()));
    EXPECT_THAT(found.output, HasSubstr("IiwaController/JointPtpMoveSkill fits: type "
                                        "JointPtpMoveSkillType < PtpMoveSkillType < "
                                        "MoveSkillType < SkillType, reach "));
    EXPECT_THAT(found.output, HasSubstr(" m >= 0.5 m, payload 7 kg >= 5 kg"));
    EXPECT_THAT(found.output, HasSubstr(unknown_.url()));
    EXPECT_THAT(found.output, HasSubstr("does not fit: "));
    EXPECT_THAT(found.output, HasSubstr("payload unknown"));
}

TEST_F(Find, EndsWithStatusOneIfNothingFits) {
    ASSERT_TRUE(known_);
    const auto too_far = find({"MoveSkillType", "--reach", "5"});
    EXPECT_EQ(too_far.status, 1);
    EXPECT_THAT(too_far.output, HasSubstr(" m < 5 m"));
    const auto none = find({"GraspGripperSkillType"});
    EXPECT_EQ(none.status, 1);
    EXPECT_THAT(none.output, HasSubstr("nothing fits"));
}

TEST_F(Find, ListsEverySkillOfADerivedTypeInJson) {
    ASSERT_TRUE(known_);
    const auto found = find({"MoveSkill", "--json"});
    EXPECT_EQ(found.status, 0);
    const auto json = nlohmann::json::parse(found.output);
    EXPECT_EQ(json.at("candidates").size(), 8U) << "four moves of either arm";
    EXPECT_TRUE(json.at("silent").empty());
    for (const auto& candidate : json.at("candidates")) {
        EXPECT_TRUE(candidate.at("fits").get<bool>());
        EXPECT_EQ(candidate.at("told_by"), lds_.url());
        EXPECT_GT(candidate.at("reach").get<double>(), 0.5);
    }
}

TEST_F(Find, KnowsAComponentByItsTaskAndByTheArmThatItUses) {
    ASSERT_TRUE(known_);
    const auto component = serveDiscovered("swing", lds_.url());
    ASSERT_TRUE(lds_.awaitKnown("swing"));
    const auto found = find({"Sequence", "--reach", "0.6", "--payload", "5"});
    EXPECT_EQ(found.status, 0);
    const auto of_arm = " (of iiwa-a, " + strong_.url() + ")";
    EXPECT_THAT(found.output, HasSubstr(component.url()));
    EXPECT_THAT(found.output, HasSubstr("SwingSkill fits: term urn:metier:dictionary:sequence, "));
    EXPECT_THAT(found.output, HasSubstr(" m >= 0.6 m" + of_arm));
    EXPECT_THAT(found.output, HasSubstr("payload 7 kg >= 5 kg" + of_arm));
    EXPECT_THAT(found.output,
                HasSubstr("does not fit: no Sequence, its terms: urn:metier:dictionary:move"));
    const auto too_far = find({"Sequence", "--reach", "5"});
    EXPECT_EQ(too_far.status, 1);
    EXPECT_THAT(too_far.output, HasSubstr(" m < 5 m" + of_arm));
}

TEST_F(Find, ListsWhoeverDoesNotAnswerAsSuch) {
    ASSERT_TRUE(known_);
    strong_.signal(SIGSTOP);
    const auto found = find({"JointPtpMoveSkillType"});
    strong_.signal(SIGCONT);
    EXPECT_EQ(found.status, 0);
    EXPECT_THAT(found.output, HasSubstr(strong_.url()));
    EXPECT_THAT(found.output, HasSubstr("does not answer: "));
    EXPECT_THAT(found.output, HasSubstr("fits"));
}

/// Two arms and a component that only one of them serves, found by their discovery server.
class FoundServers : public Find {
protected:
    Finished onFound(std::vector<std::string> arguments) const {
        arguments.insert(arguments.end(), {"--discovery", lds_.url()});
        return runMetier(arguments);
    }

    ServerProcess swing_ = serveDiscovered("swing", lds_.url());
    bool all_known_ = known_ && lds_.awaitKnown("swing");
};

TEST_F(FoundServers, AreListedAndHalted) {
    ASSERT_TRUE(all_known_);
    const auto list = onFound({"list"});
    EXPECT_EQ(list.status, 0) << list.output;
    for (const auto* server : {&strong_, &unknown_, &swing_}) {
        EXPECT_THAT(list.output, HasSubstr("found " + server->url() + " "));
    }
    EXPECT_EQ(onFound({"halt"}).status, 0);
    const auto client = connectTo(unknown_.url());
    EXPECT_EQ(openSkill(*client, "JointPtpMoveSkill").state(), skill::State::halted);
}

TEST_F(FoundServers, TheOneThatHasTheSkillRunsIt) {
    ASSERT_TRUE(all_known_);
    const auto run = onFound({"run", "SwingSkill", "--set", "Target=0,0.5,0,-1,0,1,0"});
    EXPECT_EQ(run.status, 0) << run.output;
    EXPECT_THAT(run.output, HasSubstr("found " + swing_.url() + " swing (" + lds_.url() + ")"));
    EXPECT_EQ(onFound({"halt", "--skill", "SwingSkill"}).status, 0);
    EXPECT_EQ(onFound({"reset", "SwingSkill"}).status, 0);
}

TEST_F(FoundServers, ThatCannotBeToldApartRunNothing) {
    ASSERT_TRUE(all_known_);
    const auto refused = onFound({"run", "JointPtpMoveSkill"});
    EXPECT_EQ(refused.status, 2) << refused.output;
    EXPECT_THAT(refused.output, HasSubstr("2 servers have JointPtpMoveSkill: name one of "));
    const auto none = onFound({"run", "WeldSkill"});
    EXPECT_EQ(none.status, 1) << none.output;
    EXPECT_THAT(none.output, HasSubstr("no server has WeldSkill; "));
}

TEST_F(FoundServers, MayHaveASkillIfTheyDoNotAnswer) {
    ASSERT_TRUE(all_known_);
    unknown_.kill();
    const auto refused = onFound({"run", "JointPtpMoveSkill"});
    EXPECT_NE(refused.status, 0) << "the other arm has moved";
    EXPECT_THAT(refused.output, HasSubstr(unknown_.url() + " may have JointPtpMoveSkill, too"));
    EXPECT_NE(onFound({"run", "SwingSkill", "--set", "Target=0,0.5,0,-1,0,1,0"}).status, 0);
}

TEST_F(FoundServers, AreWatchedTogether) {
    ASSERT_TRUE(all_known_);
    auto watch = link::ChildProcess::start(
        metierCommand({"watch", "--json", "--count", "2", "--discovery", lds_.url()}),
        link::ErrorOutput::with_output);
    ASSERT_TRUE(watch);
    const auto line = [&watch] { return watch->readLine(inAMinute()).value_or(""); };
    for (auto text = line(); !text.starts_with("watching "); text = line()) {
        ASSERT_THAT(text, HasSubstr("found "));
    }
    for (const auto* server : {&strong_, &unknown_}) {
        ASSERT_EQ(runMetier({"halt", server->url(), "--skill", "JointPtpMoveSkill"}).status, 0);
        const auto seen = nlohmann::json::parse(line());
        EXPECT_EQ(seen.at("server"), server->url());
        EXPECT_EQ(seen.at("to"), "Halted");
    }
    EXPECT_EQ(watch->waitUntil(inAMinute()), 0);
}

TEST(FoundServersOfAFolder, AreThoseOfItsCellFile) {
    const auto port = lastingPort();
    const auto folder = std::filesystem::path(::testing::TempDir()) / ("cell_of_folder_" + port);
    std::filesystem::create_directories(folder);
    std::ofstream(folder / "cell.toml") << fmt::format(
        "name = \"here\"\n[[server]]\nname = \"iiwa\"\nkind = \"arm\"\n"
        "port = {}\ndriver = {{ type = \"simulator\" }}\n"
        "model = \"{}/models/iiwa7.toml\"\nnodeset = \"iiwa\"\n"
        "skills = [\"CartesianPtpMoveSkill\", \"CartesianLinearMoveSkill\", \"JointPtpMoveSkill\", "
        "\"JointLinearMoveSkill\"]\nstall_limit = 2.0\n",
        port, METIER_SOURCE_DIR);
    const ServerProcess arm("iiwa", {}, folder / "cell.toml");
    const auto here = [&folder](const std::vector<std::string>& arguments) {
        std::vector<std::string> command{"env", "-C", folder.string()};
        const auto program = metierCommand(arguments);
        command.insert(command.end(), program.begin(), program.end());
        return runToEnd(command);
    };
    const auto run =
        here({"run", "JointPtpMoveSkill", "--set", "TargetJointPosition=0,0.5,0,-1,0,1,0"});
    EXPECT_EQ(run.status, 0) << run.output;
    EXPECT_THAT(run.output, HasSubstr("found " + arm.url() + " iiwa (cell.toml)"));
    for (const auto& arguments : std::vector<std::vector<std::string>>{
             {"list"},
             {"halt", "--skill", "JointPtpMoveSkill"},
             {"reset", "JointPtpMoveSkill"},
             {"square", "--laps", "1", "--svg", (folder / "square.svg").string()}}) {
        const auto done = here(arguments);
        EXPECT_EQ(done.status, 0) << arguments.front() << ": " << done.output;
    }
    std::filesystem::remove_all(folder);
}

TEST_F(Find, LetsSquareMoveEveryArmThatIsFound) {
    ASSERT_TRUE(known_);
    const auto svg = ::testing::TempDir() + "found_square.svg";
    const auto run =
        runMetier({"square", "--discovery", lds_.url(), "--laps", "1", "--json", "--svg", svg},
                  Errors::left_out);
    EXPECT_EQ(run.status, 0) << run.output;
    const auto arms = nlohmann::json::parse(run.output);
    EXPECT_EQ(arms.size(), 2U) << run.output;
    std::filesystem::remove(svg);
}

TEST(FoundServersOfNobody, AreAFailureThatSaysWhereItLooked) {
    for (const auto& line : std::vector<std::vector<std::string>>{
             {"list"}, {"run", "AnySkill"}, {"watch"}, {"halt"}, {"square"}, {"pick-place"}}) {
        auto arguments = line;
        arguments.insert(arguments.end(), {"--discovery", "opc.tcp://127.0.0.1:1"});
        const auto refused = runMetier(arguments);
        EXPECT_EQ(refused.status, 1) << line.front();
        EXPECT_THAT(refused.output, HasSubstr("discovery server opc.tcp://127.0.0.1:1: "));
    }
}

std::string compositionFile(const std::string& name) {
    return (std::filesystem::path(METIER_SOURCE_DIR) / "tests" / "system" / "compositions" / name)
        .string();
}

TEST_F(Find, NamesWhatFitsEachSkillThatACompositionUses) {
    ASSERT_TRUE(known_);
    const auto found = find({compositionFile("corner.toml")});
    EXPECT_EQ(found.status, 0) << found.output;
    EXPECT_THAT(found.output, HasSubstr("ptp: CartesianPtpMoveSkillType\n" + strong_.url()));
    EXPECT_THAT(found.output, HasSubstr("IiwaController/CartesianPtpMoveSkill fits: "));
    EXPECT_THAT(found.output, HasSubstr("line: CartesianLinearMoveSkillType\n"));
    EXPECT_THAT(found.output, HasSubstr("steps:\n"));
    const auto lacking = find({compositionFile("corner_by_parts.toml"), "--json"});
    EXPECT_EQ(lacking.status, 1) << "nobody serves a LineToSkill";
    const auto plan = nlohmann::json::parse(lacking.output);
    EXPECT_EQ(plan.at("skill"), "CornerByPartsSkill");
    EXPECT_EQ(plan.at("possible"), false);
    ASSERT_EQ(plan.at("roles").size(), 2U);
    EXPECT_EQ(plan.at("roles").at(0).at("role"), "ptp");
    EXPECT_EQ(plan.at("roles").at(0).at("candidates").size(), 2U) << "of either arm";
    EXPECT_TRUE(plan.at("roles").at(1).at("candidates").empty());
    const auto& first = plan.at("steps").at(0);
    EXPECT_EQ(first.at("role"), "ptp");
    EXPECT_EQ(first.at("by").size(), 2U);
    EXPECT_EQ(first.at("by").at(0).at("skill"), "CartesianPtpMoveSkill");
    EXPECT_EQ(plan.at("steps").back().at("by").size(), 0U) << "nobody can";
    const auto left_out = find({compositionFile("corner_if_possible.toml")});
    EXPECT_EQ(left_out.status, 0) << left_out.output;
    EXPECT_THAT(left_out.output, HasSubstr("nothing fits; its steps are left out"));
    const auto strong = find({compositionFile("corner.toml"), "--payload", "5"});
    EXPECT_EQ(strong.status, 0);
    EXPECT_THAT(strong.output, HasSubstr("payload unknown")) << "of the other arm";
}

TEST(FindWithoutDiscovery, AsksTheServersThatAreNamed) {
    const auto arm = serveDiscovered("iiwa-a", "opc.tcp://127.0.0.1:1");
    const auto found = runMetier({"find", "JointPtpMoveSkillType", "--at", arm.url()});
    EXPECT_EQ(found.status, 0);
    EXPECT_THAT(found.output, HasSubstr(arm.url()));
    const auto nobody =
        runMetier({"find", "JointPtpMoveSkillType", "--at", "opc.tcp://127.0.0.1:1"});
    EXPECT_EQ(nobody.status, 1);
    EXPECT_THAT(nobody.output, HasSubstr("does not answer"));
}

TEST(FindWithoutDiscovery, SaysThatADiscoveryServerIsDown) {
    const auto found =
        runMetier({"find", "JointPtpMoveSkillType", "--discovery", "opc.tcp://127.0.0.1:1"});
    EXPECT_EQ(found.status, 1);
    EXPECT_THAT(found.output, HasSubstr("discovery server opc.tcp://127.0.0.1:1: "));
}

}  // namespace
}  // namespace metier::system_tests
