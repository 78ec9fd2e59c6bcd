// Which tab has control of which servers, and how it loses it.
#include "tabs.hpp"

#include <gmock/gmock.h>

#include <set>
#include <string>

#include "cell_bench.hpp"

namespace metier::dashboard {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

const auto kMine = [](const json& control) { return control.at("mine") == true; };
const auto kFree = [](const json& control) { return control.at("owner") == ""; };

class TabsOfACell : public CellBench {
protected:
    TabsOfACell() {
        arm_.serve();
        other_.serve();
        watch({.name = "arm", .url = arm_.url()});
        watch({.name = "other", .url = other_.url(), .uses = {"arm"}});
    }

    /// As the server has it.
    std::string holder() {
        return arm_.bench()
            .server()
            .call([this] { return arm_.bench().control().holder().client_name; })
            .value();
    }
    Reply control(const json& body) { return commands_.control(body, anybody()); }
    Reply takeAs(const std::string& tab, const std::string& server) {
        return control({{"tab", tab}, {"server", server}, {"action", "take"}});
    }

    ArmByHand arm_;
    ArmByHand other_;
};

TEST_F(TabsOfACell, HaveControlUntilTheyReleaseIt) {
    EXPECT_EQ(takeAs(shown_.id(), "arm").body.at("taken"), json::array({"arm"}));
    EXPECT_EQ(shown_.await("control", kMine).at("key"), "arm/BenchController");
    EXPECT_THAT(holder(), HasSubstr("metier dashboard"));
    {
        const auto session = tabs_.session(shown_.id(), *anybody(), "arm").value();
        EXPECT_NE(session->epochOf("arm/BenchController").value_or(0), 0U);
        EXPECT_EQ(session->epochOf("arm/Another").error().code, Errc::locked);
    }
    EXPECT_EQ(tabs_.session(shown_.id(), *anybody(), "other").error().code, Errc::locked);

    const auto released = control({{"tab", shown_.id()}, {"server", "arm"}, {"action", "release"}});
    EXPECT_EQ(released.body.at("released"), json::array({"arm"}));
    shown_.await("control", kFree);
    EXPECT_EQ(tabs_.session(shown_.id(), *anybody(), "arm").error().code, Errc::locked);
}

TEST_F(TabsOfACell, KeepTheControlThatTheyHaveWhenTheyTakeItAgain) {
    takeAs(shown_.id(), "arm");
    const auto session = tabs_.session(shown_.id(), *anybody(), "arm").value();
    EXPECT_EQ(takeAs(shown_.id(), "arm").status, 200);
    EXPECT_EQ(tabs_.session(shown_.id(), *anybody(), "arm").value(), session);
}

TEST_F(TabsOfACell, GiveBackAllWhenTheyAreClosed) {
    tabs_.open("closing", anybody());
    ASSERT_EQ(takeAs("closing", "arm").status, 200);
    ASSERT_EQ(takeAs("closing", "other").status, 200);
    tabs_.close("closing");
    tabs_.close("closing");
    EXPECT_EQ(holder(), "");
    EXPECT_EQ(takeAs("closing", "arm").status, 404) << "its stream has ended";
    EXPECT_EQ(takeAs(shown_.id(), "arm").status, 200);
}

TEST_F(TabsOfACell, AreRefusedWithTheNameOfWhoHasControl) {
    tabs_.open("abcdefgh", anybody());
    ASSERT_EQ(takeAs("abcdefgh", "arm").status, 200);
    const auto refused = takeAs(shown_.id(), "arm");
    EXPECT_EQ(refused.status, 409);
    EXPECT_THAT(errorOf(refused), HasSubstr("metier dashboard, tab abcd"));
    EXPECT_EQ(takeAs("abcdefgh", "arm").status, 200) << "its own control stays";
}

TEST_F(TabsOfACell, AreOfOnePersonAlone) {
    const Person stranger(connector_, watches_, "stranger", "x");
    for (const auto& refused :
         {tabs_.check(shown_.id(), stranger), tabs_.release(shown_.id(), stranger, "arm")}) {
        ASSERT_FALSE(refused);
        EXPECT_EQ(refused.error().code, Errc::access_denied);
    }
    EXPECT_EQ(tabs_.session(shown_.id(), stranger, "arm").error().code, Errc::access_denied);
    EXPECT_EQ(tabs_.check("none", *anybody()).error().code, Errc::not_found);
}

TEST_F(TabsOfACell, TakeNothingOfAServerThatIsNotThere) {
    EXPECT_EQ(takeAs(shown_.id(), "nobody").status, 404);
    watches_.add({.name = "away", .url = "opc.tcp://127.0.0.1:1"});
    EXPECT_EQ(takeAs(shown_.id(), "away").status, 502);
    EXPECT_EQ(control({{"tab", shown_.id()}, {"server", "away"}, {"action", "release"}}).status,
              200)
        << "nothing is held there";
}

TEST_F(TabsOfACell, TakeWhatTheyCanOfAllAndNameTheRest) {
    watches_.add({.name = "away", .url = "opc.tcp://127.0.0.1:1"});
    const auto taken = takeAs(shown_.id(), "all");
    EXPECT_EQ(taken.status, 200);
    EXPECT_EQ(taken.body.at("taken"), json::array({"other"}));
    EXPECT_EQ(taken.body.at("left_out"), json::parse(R"([{"server":"arm","used_by":"other"}])"));
    ASSERT_EQ(taken.body.at("failed").size(), 1U);
    EXPECT_EQ(taken.body.at("failed").at(0).at("server"), "away");
    EXPECT_EQ(taken.body.at("failed").at(0).at("code"), "connection_lost");
    takeAs(shown_.id(), "arm");
    const auto released = control({{"tab", shown_.id()}, {"action", "release"}});
    EXPECT_EQ(released.body.at("released"), json::array({"arm", "other", "away"}))
        << "also of what others use";
    EXPECT_EQ(holder(), "");
}

TEST_F(TabsOfACell, AskForSomethingThatThereIs) {
    for (const auto& body :
         {json::object(), json{{"tab", shown_.id()}}, json{{"action", "take"}},
          json{{"tab", shown_.id()}, {"action", "steal"}},
          json{{"tab", shown_.id()}, {"action", "Take"}}, json{{"tab", 7}, {"action", "take"}},
          json{{"tab", shown_.id()}, {"action", "take"}, {"server", 7}}}) {
        EXPECT_EQ(control(body).status, 400) << body;
    }
}

TEST_F(TabsOfACell, HearThatTheirControlIsLost) {
    ASSERT_EQ(takeAs(shown_.id(), "arm").status, 200);
    shown_.await("control", kMine);
    const auto held = tabs_.session(shown_.id(), *anybody(), "arm").value();
    arm_.bench().onServer([this] {
        auto& control = arm_.bench().control();
        control.sessionClosed(control.holder().session_id);
    });
    const auto alarm = shown_.await("alarm", [](const json&) { return true; });
    EXPECT_EQ(alarm.at("server"), "arm");
    EXPECT_THAT(alarm.at("message").get<std::string>(),
                HasSubstr("control of arm/BenchController is lost"));
    EXPECT_FALSE(held->holdsAll());
    EXPECT_EQ(held->epochOf("arm/BenchController").error().code, Errc::locked);
    const auto refused = commands_.start({{"tab", shown_.id()},
                                          {"key", keyOf("arm", "MoveSkill")},
                                          {"parameters", {{"TargetJointPosition", {0, 0}}}}},
                                         anybody());
    EXPECT_EQ(refused.status, 409);
    EXPECT_EQ(takeAs(shown_.id(), "arm").status, 200) << "it may take it anew";
    EXPECT_NE(tabs_.session(shown_.id(), *anybody(), "arm").value(), held);
}

class PageWithoutLeases : public ::testing::Test {
protected:
    PageWithoutLeases() {
        board_.addServer("lamp", "lamp", "opc.tcp://127.0.0.1:1");
        board_.changeControl(lamp_.key, [](ControlState& state) { state.server = "lamp"; });
    }

    ManualClock clock_;
    Board board_{{{"name", "test"}}, clock_};
    ShownTab one_{board_, "one"};
    ShownTab two_{board_, "two"};
    const LinkedController lamp_{"lamp/", "", {}, false};
    ControlsOfPage ones_{board_};
    ControlsOfPage twos_{board_};
};

TEST_F(PageWithoutLeases, GivesControlToOneTab) {
    ASSERT_TRUE(ones_.take(lamp_, "one", "tab one"));
    EXPECT_TRUE(ones_.holds("lamp/"));
    EXPECT_EQ(one_.await("control", kMine).at("owner"), "tab one");
    EXPECT_TRUE(ones_.take(lamp_, "one", "tab one")) << "it has it";
    const auto refused = twos_.take(lamp_, "two", "tab two");
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::locked);
    EXPECT_EQ(refused.error().message, "lamp/: \"tab one\" has control");
    EXPECT_FALSE(twos_.holds("lamp/"));
    EXPECT_FALSE(twos_.take(lamp_, "one", "tab one")) << "another session of the same tab";
    EXPECT_EQ(two_.await("control", [](const json&) { return true; }).at("mine"), false);
}

TEST_F(PageWithoutLeases, GivesBackOnlyWhatATabHas) {
    ASSERT_TRUE(ones_.take(lamp_, "one", "tab one"));
    EXPECT_EQ(twos_.release().size(), 0U);
    EXPECT_FALSE(twos_.take(lamp_, "two", "tab two")) << "not released by who did not have it";
    EXPECT_EQ(ones_.release(), std::set<std::string>{"lamp/"});
    EXPECT_FALSE(ones_.holds("lamp/"));
    one_.await("control", kFree);
    EXPECT_TRUE(twos_.take(lamp_, "two", "tab two"));
}

TEST_F(PageWithoutLeases, ShowsItAgainAfterItsServerWasAway) {
    board_.setOffer("lamp", {});
    ASSERT_TRUE(ones_.take(lamp_, "one", "tab one"));
    one_.await("control", kMine);
    board_.setDisconnected("lamp", "gone");
    one_.await("control", kFree);
    EXPECT_FALSE(twos_.take(lamp_, "two", "tab two")) << "tab one still has its session";
    board_.setOffer("lamp", {});
    EXPECT_EQ(one_.await("control", kMine).at("owner"), "tab one");
}

}  // namespace
}  // namespace metier::dashboard
