// How events of servers change what is shown.
#include "transitions.hpp"

#include <gmock/gmock.h>

#include <chrono>
#include <string>

#include "metier/base/clock.hpp"
#include "shown_tab.hpp"

namespace metier::dashboard {
namespace {

using namespace std::chrono_literals;
using skill::Reason;
using skill::State;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr const char* kMove = "ur5/C/Move";

class TransitionsOfASkill : public ::testing::Test {
protected:
    void tell(State from, State to, Reason reason = Reason::none, std::string text = "") {
        skill::TransitionEvent event;
        event.from = from;
        event.to = to;
        event.reason = reason;
        event.reason_text = std::move(text);
        event.execution_id = "e1";
        event.severity = 500;
        event.time = UtcTime{1'500ms};
        transition_(event);
    }
    SkillState shown() const { return board_.skill(kMove).value(); }

    const SystemClock clock_;
    Board board_{{{"name", "test"}}, clock_};
    ShownTab tab_{board_};
    client::AsyncSkill::OnTransition transition_ = transitionsTo(board_, kMove);
};

TEST_F(TransitionsOfASkill, AreItsStateFromThenOn) {
    tell(State::ready, State::running);
    EXPECT_EQ(shown().state, "Running");
    EXPECT_EQ(shown().sub_state, "Executing");
    EXPECT_EQ(shown().execution, "e1");
    EXPECT_EQ(shown().since, 1.5);
    tell(State::running, State::ready, Reason::finished, "done");
    EXPECT_EQ(shown().state, "Ready");
    EXPECT_EQ(shown().sub_state, "");
    EXPECT_EQ(shown().reason, "Finished");
    EXPECT_EQ(shown().reason_text, "done");
}

TEST_F(TransitionsOfASkill, SayWhyItIsHalted) {
    for (const auto& [reason, sub_state] : {std::pair{Reason::by_client, "HaltedByClient"},
                                            {Reason::error, "HaltedError"},
                                            {Reason::force_exceeded, "HaltedForce"},
                                            {Reason::device_lost, "HaltedDeviceLost"},
                                            {Reason::limit_violated, "HaltedLimit"}}) {
        tell(State::running, State::halted, reason);
        EXPECT_EQ(shown().sub_state, sub_state);
    }
}

TEST_F(TransitionsOfASkill, ForgetStepAndProgressOfTheExecutionBefore) {
    const auto half = [](SkillState& state) {
        state.progress = 0.5;
        state.step = "grasp";
    };
    board_.changeSkill(kMove, half);
    tell(State::running, State::suspended, Reason::by_client);
    tell(State::suspended, State::running, Reason::by_client);
    EXPECT_EQ(shown().progress, 0.5) << "the same execution goes on";
    EXPECT_EQ(shown().step, "grasp");
    tell(State::running, State::ready, Reason::finished);
    EXPECT_EQ(shown().step, "grasp") << "the last one is shown until the next begins";
    tell(State::ready, State::running);
    EXPECT_FALSE(shown().progress);
    EXPECT_EQ(shown().step, "");
}

TEST_F(TransitionsOfASkill, AreNoAlarmIfSomebodyAskedForThem) {
    tab_.seen();
    tell(State::ready, State::running);
    tell(State::running, State::halted, Reason::by_client, "by the page");
    tell(State::halted, State::ready);
    EXPECT_THAT(tab_.names(), ElementsAre("skill", "skill", "skill"));
}

TEST_F(TransitionsOfASkill, AreAnAlarmWithServerSeverityAndTime) {
    tab_.seen();
    tell(State::running, State::halted, Reason::device_lost);
    const auto alarm = tab_.await("alarm", [](const auto&) { return true; });
    EXPECT_EQ(alarm.at("server"), "ur5");
    EXPECT_EQ(alarm.at("severity"), 500);
    EXPECT_EQ(alarm.at("message"), "ur5/C/Move: DeviceLost");
    EXPECT_EQ(alarm.at("time"), 1.5);
}

opcua::EventNotice noticeOf(std::vector<opcua::Value> fields) {
    opcua::EventNotice notice;
    notice.fields = std::move(fields);
    return notice;
}

TEST(AlarmOf, TakesAnEventWithAllItsFieldsAlone) {
    const auto message = opcua::Value::of(opcua::LocalizedText{"en", "hot\x1b[2J"});
    const auto severity = opcua::Value::of(std::uint16_t{900});
    const auto time = opcua::Value::of(UtcTime{2s});
    const auto alarm = alarmOf("ur5", noticeOf({message, severity, time}));
    ASSERT_TRUE(alarm);
    EXPECT_EQ(alarm->server, "ur5");
    EXPECT_EQ(alarm->severity, 900);
    EXPECT_EQ(alarm->time, 2.0);
    EXPECT_THAT(alarm->message, HasSubstr("hot"));
    EXPECT_EQ(alarm->message.find('\x1b'), std::string::npos) << "no control characters";

    EXPECT_FALSE(alarmOf("ur5", noticeOf({})));
    EXPECT_FALSE(alarmOf("ur5", noticeOf({message, severity})));
    EXPECT_FALSE(alarmOf("ur5", noticeOf({message, severity, severity})));
    EXPECT_FALSE(alarmOf("ur5", noticeOf({severity, severity, time})));
    EXPECT_FALSE(alarmOf("ur5", noticeOf({message, opcua::Value(), time})));
    auto overflow = noticeOf({message, severity, time});
    overflow.kind = opcua::EventNotice::Kind::overflow;
    EXPECT_FALSE(alarmOf("ur5", overflow));
}

}  // namespace
}  // namespace metier::dashboard
