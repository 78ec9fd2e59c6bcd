// Check of a skill that needs time for its answer, and of arms that stand elsewhere by then.
#include <gmock/gmock.h>

#include <map>

#include "metier/opcua/value.hpp"
#include "served_skills.hpp"

namespace metier::opcua_skill::testing {
namespace {

using opcua::KeyValue;
using opcua::Value;
using ::testing::ElementsAre;

class CheckOfASkill : public ServedSkills {
protected:
    CheckOfASkill() : move_(add(jointMoveDescription())) {
        serve();
        client_ = connect();
    }

    /// Status and outputs of Check; the target of axis 1 is `target`.
    opcua::Answer<opcua::CallResult> check(opcua::Client& client, double target,
                                           std::vector<KeyValue> more = {},
                                           std::string_view method = "Check") {
        more.push_back({{0, "TargetJointPosition"}, Value::of(std::vector<double>{target, 0.2})});
        std::vector<Value> inputs{Value::of(more)};
        if (method == "StartWith") {
            inputs = {Value::of(std::string()), Value::of(more), Value::of(std::int32_t{0}),
                      Value::of(std::uint64_t{0}), Value::of(UtcTime{})};
        }
        return client.call({move_.id, move_.node(method), inputs});
    }
    opcua::Answer<opcua::CallResult> check(double target, std::vector<KeyValue> more = {}) {
        return check(*client_, target, std::move(more));
    }
    void answer(Result<skill::CheckReport> report) {
        ASSERT_TRUE(server().call([&] { move_.hand->answerCheck(report); }));
    }
    static KeyValue start(const std::string& arm, std::vector<double> place) {
        return {{0, "StartJointPosition" + arm}, Value::of(place)};
    }
    static std::string reason(const opcua::Answer<opcua::CallResult>& answer) {
        return answer ? answer->outputs.at(1).as<std::string>().value_or("") : "no answer";
    }

    ServedSkill move_;
    std::unique_ptr<opcua::Client> client_;
};

TEST_F(CheckOfASkill, GivesItsAnswerToTheNextCallOfTheSameSessionWithTheSameQuestion) {
    move_.hand->keepChecks();
    auto first = check(0.1);
    ASSERT_FALSE(first);
    EXPECT_EQ(first.error().code, Errc::timeout);
    ASSERT_TRUE(move_.hand->await("check"));
    ASSERT_FALSE(check(0.1)) << "not known yet";
    answer(skill::CheckReport{.possible = false, .reason = "too far", .code = "unreachable"});
    const auto other = connect("other");
    EXPECT_FALSE(check(*other, 0.1)) << "that is the question of another session";
    ASSERT_TRUE(move_.hand->await("check"));
    const auto answered = check(0.1);
    ASSERT_TRUE(answered) << answered.error().message;
    EXPECT_EQ(answered->outputs.at(0).as<bool>(), false);
    EXPECT_EQ(reason(answered), "too far");
    EXPECT_EQ(answered->outputs.at(7).as<std::string>(), "unreachable");
    EXPECT_FALSE(check(0.1)) << "asked anew: an answer is given once";
    ASSERT_TRUE(move_.hand->await("check"));
}

TEST_F(CheckOfASkill, KeepsTheQuestionsOfOneSessionApart) {
    move_.hand->keepChecks();
    ASSERT_FALSE(check(0.1));
    ASSERT_TRUE(move_.hand->await("check"));
    answer(skill::CheckReport{.reason = "first"});
    ASSERT_FALSE(check(0.3));
    ASSERT_TRUE(move_.hand->await("check"));
    answer(skill::CheckReport{.reason = "second"});
    EXPECT_EQ(reason(check(0.1)), "first");
    EXPECT_EQ(reason(check(0.3)), "second");
}

TEST_F(CheckOfASkill, ForgetsTheOldestOfTooManyQuestions) {
    move_.hand->keepChecks();
    for (int i = 0; i < 9; ++i) {
        ASSERT_FALSE(check(0.01 * i));
        ASSERT_TRUE(move_.hand->await("check"));
        answer(skill::CheckReport{.reason = std::to_string(i)});
    }
    EXPECT_EQ(reason(check(0.01)), "1");
    EXPECT_EQ(reason(check(0.08)), "8");
    EXPECT_FALSE(check(0.0)) << "asked anew";
}

TEST_F(CheckOfASkill, TakesAndReportsThePlacesOfArms) {
    move_.hand->keepChecks();
    const std::vector starts{start("", {1.0, 2.0}), start("@opc.tcp://else:1", {3.0})};
    ASSERT_FALSE(check(0.1, starts));
    ASSERT_TRUE(move_.hand->await("check"));
    EXPECT_EQ(move_.hand->checkedStarts(),
              (skill::ArmPositions{{"", {1.0, 2.0}}, {"opc.tcp://else:1", {3.0}}}));
    answer(skill::CheckReport{.ends = {{"", {0.1}}, {"opc.tcp://else:1", {}}},
                              .ends_known = true,
                              .notes = {"one", "two"}});
    const auto answered = check(0.1, starts);
    ASSERT_TRUE(answered);
    std::map<std::string, std::vector<double>> ends;
    const auto published = answered->outputs.at(8).as<std::vector<KeyValue>>().value();
    for (const auto& [key, value] : published) {
        ends[key.name] = value.as<std::vector<double>>().value();
    }
    EXPECT_EQ(ends, (std::map<std::string, std::vector<double>>{
                        {"EndJointPosition", {0.1}}, {"EndJointPosition@opc.tcp://else:1", {}}}));
    EXPECT_THAT(answered->outputs.at(9).as<std::vector<std::string>>().value(),
                ElementsAre("one", "two"));
}

TEST_F(CheckOfASkill, ReportsThatItDoesNotKnowWhichArmsMove) {
    const auto answered = check(0.1);
    ASSERT_TRUE(answered);
    EXPECT_EQ(answered->outputs.at(0).as<bool>(), true);
    EXPECT_TRUE(answered->outputs.at(8).isEmpty());
}

TEST_F(CheckOfASkill, RefusesPlacesThatAreNone) {
    const KeyValue text{{0, "StartJointPosition"}, Value::of("home")};
    EXPECT_THAT(reason(check(0.1, {text})), ::testing::HasSubstr("StartJointPosition: "));
    EXPECT_EQ(reason(check(0.1, {start("", {1}), start("", {1})})),
              "StartJointPosition is given twice");
    EXPECT_EQ(reason(check(0.1, {start("s", {1})})), "no parameter StartJointPositions");
    const auto started = check(*client_, 0.1, {start("", {1, 2})}, "StartWith");
    ASSERT_FALSE(started) << "only Check takes it";
    EXPECT_EQ(started.error().code, Errc::invalid_argument);
}

}  // namespace
}  // namespace metier::opcua_skill::testing
