// Commands of people to servers, and what they are told when one is refused.
#include "commands.hpp"

#include <gmock/gmock.h>

#include <chrono>
#include <string>

#include "cell_bench.hpp"

namespace metier::dashboard {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;

class CommandsToAnArm : public CellBench {
protected:
    CommandsToAnArm() {
        arm_.serve();
        watch({.name = "arm", .url = arm_.url()});
    }

    Reply start(const json& parameters, const std::string& execution = "") {
        json body{{"tab", shown_.id()}, {"key", key_}, {"parameters", parameters}};
        if (!execution.empty()) {
            body["execution"] = execution;
        }
        return commands_.start(body, anybody());
    }
    Reply call(skill::Method method) {
        return commands_.call(method, {{"tab", shown_.id()}, {"key", key_}}, anybody());
    }
    Reply check(const json& parameters, const std::string& tab = "") {
        json body{{"key", key_}, {"parameters", parameters}};
        if (!tab.empty()) {
            body["tab"] = tab;
        }
        return commands_.check(body, anybody());
    }
    void startAnyhow() {
        ASSERT_EQ(take("arm").status, 200);
        const auto started = start(kTarget);
        ASSERT_EQ(started.status, 200) << errorOf(started);
        awaitState(key_, "Running");
    }

    static inline const json kTarget{{"TargetJointPosition", {1.0, 0.5}}};
    ArmByHand arm_;
    const std::string key_ = keyOf("arm", "MoveSkill");
};

TEST_F(CommandsToAnArm, StartAnExecutionOfTheNameThatTheyGive) {
    ASSERT_EQ(take("arm").status, 200);
    const auto started = start(kTarget, "mine");
    ASSERT_EQ(started.status, 200) << errorOf(started);
    EXPECT_EQ(started.body.at("execution"), "mine");
    EXPECT_EQ(awaitState(key_, "Running").at("execution"), "mine");
    EXPECT_EQ(start(kTarget, "mine").status, 200) << "the same again starts nothing";
    EXPECT_EQ(start(kTarget, "another").status, 409) << "it runs";
    arm_.move().execution().finish({{"Duration", 1.0}});
    EXPECT_EQ(awaitState(key_, "Ready").at("reason"), "Finished");
}

TEST_F(CommandsToAnArm, AreRefusedWithTheLimitThatTheServerNames) {
    ASSERT_EQ(take("arm").status, 200);
    const auto far = start({{"TargetJointPosition", {500.0, 0.0}}});
    EXPECT_EQ(far.status, 422);
    EXPECT_THAT(errorOf(far), AllOf(HasSubstr("MoveSkill refused Start"), HasSubstr("500")));
    const auto short_list = start({{"TargetJointPosition", {1.0}}});
    EXPECT_EQ(short_list.status, 422) << errorOf(short_list);
    const auto missing = start(json::object());
    EXPECT_EQ(missing.status, 400) << errorOf(missing);
    EXPECT_THAT(errorOf(missing), HasSubstr("TargetJointPosition"));
    arm_.move().answerStart(fail(Errc::unreachable, "out of reach: 2 m over 1 m"));
    const auto unreachable = start(kTarget);
    EXPECT_EQ(unreachable.status, 422);
    EXPECT_THAT(errorOf(unreachable), HasSubstr("out of reach: 2 m over 1 m"));
    EXPECT_EQ(board_.skill(key_)->state, "Ready");
}

TEST_F(CommandsToAnArm, AreReadBeforeAnyServerIsAsked) {
    ASSERT_EQ(take("arm").status, 200);
    for (const auto& [parameters, status] : {std::pair{json{{"TargetJointPosition", "here"}}, 400},
                                             {json{{"TargetJointPosition", {{{"x", 1}}}}}, 400},
                                             {json{{"Sped", 1}}, 404},
                                             {json(7), 400}}) {
        const auto refused = start(parameters);
        EXPECT_EQ(refused.status, status) << parameters << errorOf(refused);
        EXPECT_THAT(errorOf(refused), ::testing::Not(HasSubstr("refused Start"))) << parameters;
    }
    EXPECT_EQ(start(kTarget, std::string(1'001, 'x')).status, 400);
    EXPECT_EQ(commands_.start({{"tab", shown_.id()}}, anybody()).status, 400) << "no key";
    EXPECT_EQ(commands_.start({{"key", key_}}, anybody()).status, 400) << "no tab";
    EXPECT_EQ(
        commands_.start({{"key", "arm/BenchController/None"}, {"tab", shown_.id()}}, anybody())
            .status,
        404);
    EXPECT_EQ(commands_.start({{"key", key_}, {"tab", "nobody's"}}, anybody()).status, 404);
}

TEST_F(CommandsToAnArm, AreRefusedWhereTheStateDoesNotAllowThem) {
    ASSERT_EQ(take("arm").status, 200);
    for (const auto method :
         {skill::Method::suspend, skill::Method::resume, skill::Method::reset}) {
        const auto refused = call(method);
        EXPECT_EQ(refused.status, 409) << toString(method);
        EXPECT_THAT(errorOf(refused),
                    HasSubstr("MoveSkill refused " + std::string(toString(method))));
    }
}

TEST_F(CommandsToAnArm, PassOnWhyASkillIsNotSuspended) {
    startAnyhow();
    arm_.move().answerSuspend(fail(Errc::device_fault, "the brake is worn"));
    const auto refused = call(skill::Method::suspend);
    EXPECT_NE(refused.status, 200);
    EXPECT_THAT(errorOf(refused), HasSubstr("the brake is worn"));
    arm_.move().answerSuspend({});
    EXPECT_EQ(call(skill::Method::suspend).status, 200);
    awaitState(key_, "Suspended");
    EXPECT_EQ(call(skill::Method::resume).status, 200);
    awaitState(key_, "Running");
}

TEST_F(CommandsToAnArm, ResetADeviceThatTakesItsTime) {
    startAnyhow();
    arm_.move().execution().fail(skill::Reason::error, "blocked");
    EXPECT_EQ(awaitState(key_, "Halted").at("reason_text"), "blocked");
    arm_.move().answerReset({}, 2);
    const auto reset = call(skill::Method::reset);
    EXPECT_EQ(reset.status, 200) << errorOf(reset);
    EXPECT_EQ(arm_.move().resets(), 3);
    awaitState(key_, "Ready");
}

TEST_F(CommandsToAnArm, GiveUpAResetThatIsNotDoneOrIsRefused) {
    startAnyhow();
    arm_.move().execution().fail(skill::Reason::error, "blocked");
    awaitState(key_, "Halted");
    arm_.move().answerReset({}, 1'000'000);
    const auto slow = call(skill::Method::reset);
    EXPECT_EQ(slow.status, 504);
    EXPECT_THAT(errorOf(slow), HasSubstr("it finds its zero"));
    const auto asked = arm_.move().resets();
    EXPECT_GT(asked, 1);
    arm_.move().answerReset(fail(Errc::device_fault, "still blocked"));
    const auto refused = call(skill::Method::reset);
    EXPECT_THAT(errorOf(refused), HasSubstr("still blocked"));
    EXPECT_EQ(arm_.move().resets(), asked + 1) << "a refusal is an answer";
    EXPECT_EQ(board_.skill(key_)->state, "Halted");
}

TEST_F(CommandsToAnArm, CheckWithoutControl) {
    EXPECT_EQ(check(kTarget).body.at("possible"), true);
    arm_.move().answerStart(fail(Errc::unreachable, "out of reach"));
    const auto refused = check(kTarget);
    EXPECT_EQ(refused.status, 200);
    EXPECT_EQ(refused.body.at("possible"), false);
    EXPECT_EQ(refused.body.at("code"), "refused");
    EXPECT_THAT(refused.body.at("message").get<std::string>(), HasSubstr("out of reach"));
}

TEST_F(CommandsToAnArm, CheckAsTheTabThatHasControl) {
    ASSERT_EQ(take("arm").status, 200);
    EXPECT_EQ(check(kTarget, shown_.id()).body.at("possible"), true);
    tabs_.open("another", anybody());
    const auto other = check(kTarget, "another");
    EXPECT_EQ(other.body.at("possible"), false) << other.body;
    EXPECT_THAT(other.body.at("message").get<std::string>(), HasSubstr("metier dashboard"))
        << "who has control";
}

TEST_F(CommandsToAnArm, HaltOneSkillAndNoOther) {
    startAnyhow();
    const auto halted = commands_.haltSkill({{"key", key_}}, anybody());
    EXPECT_EQ(halted.body, (json{{"halted", {key_}}, {"failed", json::array()}}));
    awaitState(key_, "Halted");
    EXPECT_EQ(board_.skill(keyOf("arm", "TurnSkill"))->state, "Ready");
    const auto again = commands_.haltSkill({{"key", key_}}, anybody());
    EXPECT_EQ(again.body.at("halted"), json::array({key_})) << "it stands still already";
    EXPECT_EQ(commands_.haltSkill(json::object(), anybody()).status, 400);
    EXPECT_EQ(commands_.haltSkill({{"key", "arm/None"}}, anybody()).status, 404);
    EXPECT_EQ(commands_.haltSkill({{"key", "nobody/C/MoveSkill"}}, anybody()).status, 404);
}

TEST_F(CommandsToAnArm, HaltAllSkillsOfAServerOrOfAnArm) {
    const json both{keyOf("arm", "MoveSkill"), keyOf("arm", "TurnSkill")};
    for (const auto& wanted : {json{{"server", "arm"}}, json{{"arm", "arm"}}, json::object(),
                               json{{"server", "arm"}, {"arm", "arm"}}}) {
        const auto halted = commands_.halt(wanted, anybody());
        EXPECT_EQ(halted.body.at("halted"), both) << wanted;
        EXPECT_EQ(halted.body.at("failed"), json::array()) << wanted;
    }
    for (const auto& nobody :
         {json{{"server", "none"}}, json{{"arm", "none"}}, json{{"server", "arm"}, {"arm", "x"}}}) {
        EXPECT_EQ(commands_.halt(nobody, anybody()).status, 404) << nobody;
    }
    EXPECT_EQ(commands_.halt({{"server", 7}}, anybody()).status, 400);
    EXPECT_EQ(commands_.halt({{"arm", json::array()}}, anybody()).status, 400);
}

TEST_F(CommandsToAnArm, HaltWhatCanBeHaltedAndReportTheRest) {
    watches_.add({.name = "away", .url = "opc.tcp://127.0.0.1:1"});
    const auto halted = commands_.halt(json::object(), anybody());
    EXPECT_EQ(halted.status, 200);
    EXPECT_EQ(halted.body.at("halted").size(), 2U);
    EXPECT_EQ(halted.body.at("failed"),
              json::parse(R"([{"server":"away","message":"away is not connected"}])"));
    EXPECT_EQ(commands_.halt({{"server", "away"}}, anybody()).body.at("failed").size(), 1U)
        << "people are to hear that it did not halt";
    EXPECT_EQ(commands_.haltSkill({{"key", "away/C/Move"}}, anybody()).status, 502);
}

class CommandsToServersThatHang : public CellBench {
protected:
    CommandsToServersThatHang() {
        client_options_.call_timeout = 3s;  // a sound server answers sooner, on any machine
        hanging_.serve();
        sound_.serve();
        watch({.name = "hanging", .url = hanging_.url()});
        watch({.name = "sound", .url = sound_.url()});
    }

    ArmByHand hanging_;
    ArmByHand sound_;
};

TEST_F(CommandsToServersThatHang, HaltTheOthers) {
    const auto busy = hanging_.keepBusy();
    const auto halted = commands_.halt(json::object(), anybody());
    EXPECT_EQ(halted.body.at("halted"),
              json::array({keyOf("sound", "MoveSkill"), keyOf("sound", "TurnSkill")}));
    ASSERT_EQ(halted.body.at("failed").size(), 1U);
    EXPECT_EQ(halted.body.at("failed").at(0).at("server"), "hanging");
}

TEST_F(CommandsToServersThatHang, EndWithATimeout) {
    ASSERT_EQ(take("hanging").status, 200);
    const auto busy = hanging_.keepBusy();
    const auto reply =
        commands_.call(skill::Method::suspend,
                       {{"tab", shown_.id()}, {"key", keyOf("hanging", "MoveSkill")}}, anybody());
    EXPECT_TRUE(reply.status == 504 || reply.status == 502) << reply.body;
}

}  // namespace
}  // namespace metier::dashboard
