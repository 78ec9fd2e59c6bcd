// Contents and times of the messages that tabs get.
#include "board.hpp"

#include <gmock/gmock.h>

#include <chrono>
#include <string>
#include <vector>

#include "metier/base/clock.hpp"
#include "shown_tab.hpp"

namespace metier::dashboard {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

class BoardOfACell : public ::testing::Test {
protected:
    BoardOfACell() {
        board_.addServer("ur5", "UR5", "opc.tcp://127.0.0.1:1");
        board_.addServer("iiwa", "iiwa", "opc.tcp://127.0.0.1:2");
    }

    static ServerShown offerOf(const std::string& skill) {
        ServerShown offer;
        offer.application_uri = "urn:test:" + skill;
        offer.skills = {{{"key", skill}, {"name", "Move"}, {"controller", "C"}, {"arm", "ur5"}}};
        return offer;
    }
    json serverOf(const std::string& key) const {
        const auto cell = board_.cell();
        for (const auto& server : cell.at("servers")) {
            if (server.at("key") == key) {
                return server;
            }
        }
        return {};
    }
    void setOwner(const std::string& control, const std::string& server, const std::string& owner) {
        board_.changeControl(control, [&](ControlState& state) {
            state.server = server;
            state.owner = owner;
        });
    }

    ManualClock clock_;
    Board board_{{{"name", "test"}, {"world", json::object()}}, clock_};
};

TEST_F(BoardOfACell, GivesANewTabAllThereIs) {
    board_.setOffer("ur5", offerOf("ur5/C/Move"));
    board_.changeSkill("ur5/C/Move", [](SkillState& state) {
        state.state = "Running";
        state.progress = 0.5;
        state.since = 7.0;
    });
    setOwner("ur5/C", "ur5", "somebody");
    board_.changeLive([](LiveValues& live) { live.setOfArm("ur5", "safety", "Normal"); });
    ShownTab tab(board_);
    const auto seen = tab.seen();
    ASSERT_EQ(seen.size(), 2U);
    EXPECT_EQ(seen[0].data.at("tab"), tab.id());
    const auto& snapshot = seen[1].data;
    EXPECT_EQ(snapshot.at("servers"), json::parse(R"([{"key":"ur5","connected":true,"error":null},
                              {"key":"iiwa","connected":false,"error":"not connected yet"}])"));
    const auto& skill = snapshot.at("skills").at(0);
    EXPECT_EQ(skill.at("state"), "Running");
    EXPECT_EQ(skill.at("progress"), 0.5);
    EXPECT_EQ(skill.at("since"), 7.0);
    EXPECT_EQ(snapshot.at("controls").at(0).at("owner"), "somebody");
    EXPECT_EQ(snapshot.at("live").at("arms").at("ur5").at("safety"), "Normal");
}

TEST_F(BoardOfACell, SendsWhatHasChangedAlone) {
    ShownTab tab(board_);
    tab.seen();
    const auto ready = [](SkillState& state) { state.state = "Ready"; };
    board_.changeSkill("ur5/C/Move", ready);
    EXPECT_THAT(tab.names(), ElementsAre("skill"));
    board_.changeSkill("ur5/C/Move", ready);
    EXPECT_THAT(tab.names(), IsEmpty());
    setOwner("ur5/C", "ur5", "somebody");
    EXPECT_THAT(tab.names(), ElementsAre("control"));
    setOwner("ur5/C", "ur5", "somebody");
    EXPECT_THAT(tab.names(), IsEmpty());
}

TEST_F(BoardOfACell, HasTheCellAskedForAgainWhenAServerOffersSomethingElse) {
    ShownTab tab(board_);
    tab.seen();
    board_.setOffer("ur5", offerOf("ur5/C/Move"));
    EXPECT_THAT(tab.names(), ElementsAre("cell", "server"));
    board_.setOffer("ur5", offerOf("ur5/C/Move"));
    EXPECT_THAT(tab.names(), ElementsAre("server")) << "the same again, after a new connection";
    auto uses_another = offerOf("ur5/C/Move");
    uses_another.uses = {"iiwa"};
    board_.setOffer("ur5", uses_another);
    EXPECT_THAT(tab.names(), ElementsAre("cell", "server"));
    EXPECT_EQ(serverOf("ur5").at("name"), "UR5") << "what was given is kept";
    EXPECT_EQ(serverOf("ur5").at("url"), "opc.tcp://127.0.0.1:1");
    EXPECT_EQ(serverOf("ur5").at("uses"), json::array({"iiwa"}));
    board_.addServer("ur5", "another", "opc.tcp://127.0.0.1:3");
    EXPECT_THAT(tab.names(), IsEmpty()) << "it is known";
    EXPECT_EQ(serverOf("ur5").at("name"), "UR5");
}

TEST_F(BoardOfACell, ReportsALostServerOnceAndTakesBackWhatItSaid) {
    board_.setOffer("ur5", offerOf("ur5/C/Move"));
    board_.changeSkill("ur5/C/Move", [](SkillState& state) { state.state = "Running"; });
    setOwner("ur5/C", "ur5", "somebody");
    setOwner("iiwa/C", "iiwa", "somebody");
    ShownTab tab(board_);
    tab.seen();
    board_.setDisconnected("ur5", "gone");
    const auto seen = tab.seen();
    ASSERT_EQ(seen.size(), 3U);
    EXPECT_EQ(seen[0].data, json::parse(R"({"key":"ur5","connected":false,"error":"gone"})"));
    EXPECT_EQ(seen[1].data.at("state"), "Unknown");
    EXPECT_EQ(seen[2].data.at("key"), "ur5/C") << "of another server nothing";
    EXPECT_EQ(seen[2].data.at("owner"), "");
    board_.setDisconnected("ur5", "gone");
    EXPECT_THAT(tab.names(), IsEmpty());
    board_.setDisconnected("ur5", "certificate expired");
    EXPECT_THAT(tab.names(), ElementsAre("server", "skill", "control")) << "another reason";
}

TEST_F(BoardOfACell, ShowsALeaseWithItsEnd) {
    ShownTab tab(board_);
    tab.seen();
    board_.changeControl("ur5/C", [](ControlState& state) {
        state.owner = "somebody";
        state.held_by = "another tab";
        state.lease_ms = 1'000.0;
        state.until = 17.5;
    });
    const auto leased = tab.seen().at(0).data;
    EXPECT_EQ(leased.at("lease_ms"), 1'000.0);
    EXPECT_EQ(leased.at("until"), 17.5);
    EXPECT_EQ(leased.at("mine"), false);
    board_.changeControl("ur5/C", [&](ControlState& state) {
        state = {};
        state.held_by = tab.id();
    });
    const auto free = tab.seen().at(0).data;
    EXPECT_FALSE(free.contains("lease_ms"));
    EXPECT_EQ(free.at("mine"), false) << "nobody has it";
}

TEST_F(BoardOfACell, ReportsWhenTheFirstTabComesAndTheLastOneGoes) {
    std::vector<bool> watched;
    board_.onWatched([&](bool now) { watched.push_back(now); });
    board_.closeTab("nobody");
    board_.openTab("a", 1'000);
    board_.openTab("b", 1'000);
    board_.closeTab("a");
    board_.closeTab("a");
    EXPECT_THAT(watched, ElementsAre(true));
    board_.closeTab("b");
    board_.closeTab("b");
    EXPECT_THAT(watched, ElementsAre(true, false));
    board_.openTab("c", 1'000);
    EXPECT_THAT(watched, ElementsAre(true, false, true));
}

TEST_F(BoardOfACell, ClosesAllTabsAtItsEnd) {
    const auto first = board_.openTab("a", 100'000);
    const auto second = board_.openTab("b", 100'000);
    board_.closeAll();
    EXPECT_TRUE(first->isClosed());
    EXPECT_TRUE(second->isClosed());
}

TEST_F(BoardOfACell, DatesAnAlarmWithoutATimeItself) {
    ShownTab tab(board_);
    tab.seen();
    clock_.advance(90s);
    board_.raise({"ur5", 700, "hot", 12.0});
    board_.raise({"ur5", 700, "hot", 0.0});
    const auto seen = tab.seen();
    EXPECT_EQ(seen.at(0).data.at("time"), 12.0);
    EXPECT_EQ(seen.at(1).data.at("time"), secondsOf(clock_.utcNow()));
    EXPECT_EQ(seen.at(1).data.at("severity"), 700);
}

TEST_F(BoardOfACell, SendsWhatHasChangedWithItsNextTick) {
    ShownTab tab(board_);
    tab.seen();
    clock_.advance(500ms);
    board_.changeLive([](LiveValues& live) { live.setOfArm("ur5", "missed", 3); });
    EXPECT_THAT(tab.names(), IsEmpty());
    board_.tick();
    const auto seen = tab.seen();
    ASSERT_EQ(seen.size(), 1U);
    EXPECT_EQ(seen[0].data.at("arms").at("ur5").at("missed"), 3);
    EXPECT_EQ(seen[0].data.at("t"), secondsOf(clock_.utcNow()));
    clock_.advance(900ms);
    board_.tick();
    EXPECT_THAT(tab.names(), IsEmpty()) << "no beat within a second of it";
    clock_.advance(200ms);
    board_.tick();
    EXPECT_THAT(tab.names(), ElementsAre("beat"));
}

TEST_F(BoardOfACell, ShowsPartsWhereTheyAreAndTellsTheCellOfNewOnes) {
    const auto cube = [](double x) {
        return json{{"cube", {{"pose", {x, 0, 0, 0, 0, 0}}, {"size", {1, 1, 1}}}}};
    };
    ShownTab tab(board_);
    tab.seen();
    board_.setParts(cube(1));
    EXPECT_THAT(tab.names(), ElementsAre("cell"));
    EXPECT_EQ(board_.cell().at("world").at("parts").at(0).at("name"), "cube");
    board_.tick();
    EXPECT_EQ(tab.seen().at(0).data.at("parts").at("cube").at(0), 1);
    board_.setParts(cube(2));
    EXPECT_THAT(tab.names(), IsEmpty()) << "it moves, and is the same part";
    board_.tick();
    EXPECT_EQ(tab.seen().at(0).data.at("parts").at("cube").at(0), 2);
    auto larger = cube(2);
    larger["cube"]["size"] = {2, 2, 2};
    board_.setParts(larger);
    EXPECT_THAT(tab.names(), ElementsAre("cell"));
    board_.setParts(json::object());
    EXPECT_THAT(tab.names(), ElementsAre("cell"));
    board_.tick();
    EXPECT_TRUE(tab.seen().at(0).data.at("parts").at("cube").is_null());
}

TEST_F(BoardOfACell, NamesTheArmThatASkillMoves) {
    board_.setOffer("ur5", offerOf("ur5/C/Move"));
    auto no_arm = offerOf("iiwa/C/Move");
    no_arm.skills[0]["arm"] = nullptr;
    board_.setOffer("iiwa", no_arm);
    EXPECT_EQ(board_.armOf("urn:test:ur5/C/Move", "C", "Move"), "ur5");
    EXPECT_EQ(board_.armOf("urn:test:ur5/C/Move", "D", "Move"), "");
    EXPECT_EQ(board_.armOf("urn:test:ur5/C/Move", "C", "Grasp"), "");
    EXPECT_EQ(board_.armOf("urn:another", "C", "Move"), "");
    EXPECT_EQ(board_.armOf("urn:test:iiwa/C/Move", "C", "Move"), "");
    board_.setDisconnected("ur5", "gone");
    EXPECT_EQ(board_.armOf("urn:test:ur5/C/Move", "C", "Move"), "ur5") << "its records stay";
}

TEST(SecondsOf, AreToTheMillisecond) {
    EXPECT_EQ(secondsOf(UtcTime{}), 0.0);
    EXPECT_EQ(secondsOf(UtcTime{1'234'567us}), 1.234);
    EXPECT_EQ(secondsOf(UtcTime{-1us}), -0.001) << "downward, also before 1970";
}

}  // namespace
}  // namespace metier::dashboard
