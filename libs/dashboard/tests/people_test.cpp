// Log-ins: accepted users, the time they last, and the delay after wrong passwords.
#include "people.hpp"

#include <gmock/gmock.h>

#include <chrono>
#include <future>
#include <memory>
#include <string>
#include <vector>

#include "closed_bench.hpp"

namespace metier::dashboard {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;
using ::testing::HasSubstr;

class PeopleOfAClosedCell : public CellBench {
protected:
    PeopleOfAClosedCell() : CellBench(Access::log_in) {
        client_options_ = closed_.options();
        watch({.name = "arm", .url = closed_.url()});
    }
    std::string logIn(const std::string& user) {
        return people_.login(user, "secret").value_or("");
    }

    ClosedArm closed_;
};

TEST_F(PeopleOfAClosedCell, HaveTheRoleThatTheServerGivesThem) {
    const auto anna = people_.find(logIn("anna"));
    ASSERT_TRUE(anna);
    EXPECT_EQ(anna->user(), "anna");
    EXPECT_EQ(anna->role(), "operator");
    EXPECT_FALSE(anna->isOfLab());
    const auto otto = people_.find(logIn("otto"));
    ASSERT_TRUE(otto);
    EXPECT_EQ(otto->role(), "observer");
}

TEST_F(PeopleOfAClosedCell, CommandWithTheirOwnRights) {
    for (const auto& [user, status] : {std::pair{"otto", 403}, {"anna", 200}}) {
        const auto person = people_.find(logIn(user));
        tabs_.open(user, person);
        EXPECT_EQ(commands_.control({{"tab", user}, {"server", "arm"}, {"action", "take"}}, person)
                      .status,
                  status)
            << user;
        const auto halted = commands_.halt(json::object(), person);
        EXPECT_EQ(halted.body.at("failed").empty(), status == 200) << halted.body;
    }
    shown_.await("control", [](const json& told) {
        return told.at("owner").get<std::string>().find("of anna, tab anna") != std::string::npos;
    });
}

TEST_F(PeopleOfAClosedCell, AreToldNoMoreThanThatSomethingIsWrong) {
    std::vector<std::string> texts;
    for (const auto& [user, password] : {std::pair{"anna", "wrong"}, {"nobody", "secret"}}) {
        const auto refused = people_.login(user, password);
        ASSERT_FALSE(refused);
        EXPECT_EQ(refused.error().code, Errc::access_denied);
        texts.push_back(refused.error().message);
    }
    EXPECT_EQ(texts[0], texts[1]);
}

TEST_F(PeopleOfAClosedCell, AreNotAskedForWithoutNameOrPassword) {
    for (const auto& [user, password] : {std::pair{"", "secret"}, {"anna", ""}, {"", ""}}) {
        EXPECT_EQ(people_.login(user, password).error().code, Errc::access_denied);
    }
    EXPECT_EQ(closed_.attempts(), 0);
}

TEST_F(PeopleOfAClosedCell, AreForgottenAnHourAfterTheirLastRequest) {
    const auto token = logIn("anna");
    for (int i = 0; i < 5; ++i) {
        clock_.advance(59min);
        EXPECT_TRUE(people_.find(token)) << i;
    }
    clock_.advance(61min);
    EXPECT_FALSE(people_.find(token));
    EXPECT_FALSE(people_.find(token));
}

TEST_F(PeopleOfAClosedCell, AreForgottenAfterTwelveHoursWhateverTheyDo) {
    const auto token = logIn("anna");
    for (int i = 0; i < 24; ++i) {
        EXPECT_TRUE(people_.find(token)) << i;
        clock_.advance(30min);
    }
    EXPECT_TRUE(people_.find(token));
    clock_.advance(1s);
    EXPECT_FALSE(people_.find(token));
}

TEST_F(PeopleOfAClosedCell, AreThoseOfATokenThatNobodyGuesses) {
    const auto first = logIn("anna");
    const auto second = logIn("anna");
    EXPECT_EQ(first.size(), 32U);
    EXPECT_NE(first, second);
    EXPECT_NE(people_.find(first), people_.find(second)) << "each log-in has its own tabs";
    EXPECT_FALSE(people_.find(""));
    EXPECT_FALSE(people_.find(first.substr(1)));
    people_.logout("nobody's");
    people_.logout(first);
    people_.logout(first);
    EXPECT_FALSE(people_.find(first));
    EXPECT_TRUE(people_.find(second));
}

TEST_F(PeopleOfAClosedCell, LoseTheirOldestLogInByTheTwentyFirst) {
    std::vector<std::string> tokens;
    for (int i = 0; i < 20; ++i) {
        tokens.push_back(logIn("anna"));
        clock_.advance(1s);
    }
    EXPECT_TRUE(people_.find(tokens[0])) << "and it was used now";
    const auto last = logIn("anna");
    EXPECT_TRUE(people_.find(tokens[0]));
    EXPECT_FALSE(people_.find(tokens[1])) << "it was used longest ago";
    EXPECT_TRUE(people_.find(tokens[2]));
    EXPECT_TRUE(people_.find(last));
}

TEST_F(PeopleOfAClosedCell, MayTryAgainAtOnceAfterARightPassword) {
    for (int round = 0; round < 4; ++round) {
        for (int i = 0; i < 2; ++i) {
            EXPECT_EQ(people_.login("anna", "wrong").error().code, Errc::access_denied) << round;
        }
        EXPECT_NE(logIn("anna"), "") << round;
    }
}

/// A server that is connected, and after that lets nobody in: no attempt takes any time.
class PeopleWhoGuess : public CellBench {
protected:
    PeopleWhoGuess() : CellBench(Access::log_in) {
        arm_.serve();
        watch({.name = "arm", .url = arm_.url()});
        refuse_options_ = [this] {
            ++attempts_;
            return std::optional(answer_);
        };
    }
    Error logIn(const std::string& user) { return people_.login(user, "a guess").error(); }

    ArmByHand arm_;
    Error answer_{Errc::access_denied, "wrong"};
    std::atomic<int> attempts_ = 0;
};

TEST_F(PeopleWhoGuess, WaitLongerAndLonger) {
    for (int i = 0; i < 3; ++i) {
        EXPECT_EQ(logIn("anna").code, Errc::access_denied) << i;
    }
    for (const auto wait : {1s, 2s, 4s, 8s, 16s, 32s, 60s, 60s}) {
        const auto asked = attempts_.load();
        const auto barred = logIn("anna");
        EXPECT_EQ(barred.code, Errc::resource_unavailable);
        EXPECT_THAT(barred.message, HasSubstr("wait " + std::to_string(wait.count()) + " s"));
        clock_.advance(wait - 1ms);
        EXPECT_EQ(logIn("anna").code, Errc::resource_unavailable) << wait.count();
        EXPECT_EQ(attempts_, asked) << "no server is asked, and waiting is not prolonged";
        clock_.advance(1ms);
        EXPECT_EQ(logIn("anna").code, Errc::access_denied) << wait.count();
    }
}

TEST_F(PeopleWhoGuess, HoldUpNobodyElse) {
    for (int i = 0; i < 10; ++i) {
        logIn("anna");
    }
    EXPECT_EQ(logIn("anna").code, Errc::resource_unavailable);
    EXPECT_EQ(logIn("otto").code, Errc::access_denied) << "it was asked for";
}

TEST_F(PeopleWhoGuess, AreRememberedThroughAFloodOfOtherNames) {
    for (int i = 0; i < 8; ++i) {
        logIn("anna");
        clock_.advance(60s);
    }
    logIn("anna");
    for (int name = 0; name < 1'500; ++name) {
        EXPECT_EQ(logIn("nobody" + std::to_string(name)).code, Errc::access_denied);
    }
    EXPECT_EQ(logIn("anna").code, Errc::resource_unavailable);
}

TEST_F(PeopleWhoGuess, AreNotThoseWhomNoServerAnswered) {
    answer_ = {Errc::connection_lost, "the wire is cut"};
    for (int i = 0; i < 10; ++i) {
        const auto refused = logIn("anna");
        EXPECT_EQ(refused.code, Errc::connection_lost) << i;
        EXPECT_THAT(refused.message, HasSubstr("the wire is cut"));
    }
}

TEST(PeopleOfNoServer, CannotLogIn) {
    const ManualClock clock;
    Board board({{"name", "test"}}, clock);
    const Connector connector;
    const std::vector<motion::RobotModel> models;
    Watches watches(board, connector, models);
    People people(connector, watches, Access::log_in, clock);
    for (int i = 0; i < 5; ++i) {
        EXPECT_EQ(people.login("anna", "secret").error().code, Errc::connection_lost) << i;
    }
}

class PeopleOfALab : public CellBench {};

TEST_F(PeopleOfALab, AreAllTheSameAndMayCommand) {
    EXPECT_TRUE(people_.isLab());
    EXPECT_EQ(people_.find(""), people_.find("whatever"));
    EXPECT_EQ(anybody()->role(), "operator");
    EXPECT_EQ(people_.login("anna", "secret").error().code, Errc::access_denied);
    people_.logout("");
    EXPECT_TRUE(anybody());
}

TEST_F(PeopleOfALab, HaveSessionsUntilTheServerEnds) {
    auto arm = std::make_unique<ArmByHand>();
    arm->serve();
    watch({.name = "arm", .url = arm->url()});
    const auto session = anybody()->session("arm").value();
    EXPECT_EQ(anybody()->session("arm").value(), session) << "it is kept";
    EXPECT_EQ(anybody()->session("nobody").error().code, Errc::not_found);
    const auto ended = std::make_shared<std::promise<void>>();
    session->client().onConnectionLost([ended](const opcua::Failure&) { ended->set_value(); });
    arm.reset();
    // The watch's connection and this one are lost one after the other, in any order.
    shown_.await("server", [](const json& told) { return told.at("connected") == false; });
    ASSERT_EQ(ended->get_future().wait_for(30s), std::future_status::ready);
    const auto lost = anybody()->session("arm");
    ASSERT_FALSE(lost);
    EXPECT_THAT(lost.error().message, HasSubstr("arm: "));
}

}  // namespace
}  // namespace metier::dashboard
