#include "transition_log.hpp"

#include <gmock/gmock.h>

#include <chrono>
#include <future>

namespace metier::client {
namespace {

using Kind = opcua::EventNotice::Kind;
using ::testing::HasSubstr;

/// Counts what the log calls.
struct Heard {
    TransitionLog::Watch watch() {
        return {.on_transition = [this](const auto& /*event*/) { ++transitions; },
                .on_missed = [this] { ++missed; },
                .on_ended = [this](const std::string& why) { ended = why; }};
    }

    int transitions = 0;
    int missed = 0;
    std::string ended;
};

TEST(TransitionLog, SaysThatTransitionsMayHaveBeenMissed) {
    TransitionLog log;
    Heard heard;
    log.watch(heard.watch());
    log.add({Kind::interrupted, {}, {}});
    EXPECT_EQ(heard.missed, 0) << "its end will say it";
    log.add({Kind::overflow, {}, {}});
    EXPECT_EQ(heard.missed, 1);
    log.add({Kind::resumed, {}, {}});
    EXPECT_EQ(heard.missed, 2);
    log.add({Kind::event, {}, {}});
    EXPECT_EQ(heard.missed, 3) << "an event that cannot be understood";
    EXPECT_EQ(heard.transitions, 0);
    EXPECT_EQ(heard.ended, "");
}

TEST(TransitionLog, SaysThatNothingWillComeAnyMore) {
    TransitionLog log;
    Heard heard;
    log.watch(heard.watch());
    log.add({Kind::ended, {}, opcua::status::kBadTimeout});
    EXPECT_THAT(heard.ended, HasSubstr("BadTimeout"));
    EXPECT_EQ(heard.missed, 0);
}

TEST(TransitionLog, OfStatesHasTheTransitionsThatWentByUnseen) {
    using skill::State;
    TransitionLog log;
    std::vector<std::pair<State, State>> seen;
    log.watch({.on_transition = [&](const skill::TransitionEvent& event) {
        seen.emplace_back(event.from, event.to);
    }});
    log.addState(State::ready, {});
    EXPECT_TRUE(seen.empty());
    log.addState(State::suspended, {});
    log.addState(State::halted, {});
    log.addState(State::halted, {});
    log.addState(State::running, {});
    EXPECT_THAT(seen, ::testing::ElementsAre(std::pair(State::ready, State::running),
                                             std::pair(State::running, State::suspended),
                                             std::pair(State::suspended, State::halted),
                                             std::pair(State::halted, State::ready),
                                             std::pair(State::ready, State::running)));
}

TEST(TransitionLog, NeedsNobodyToListen) {
    TransitionLog log;
    log.add({Kind::overflow, {}, {}});
    log.add({Kind::ended, {}, opcua::status::kBadTimeout});
    const auto found = log.await(log.mark(), std::chrono::steady_clock::now(),
                                 [](const auto& /*event*/) { return true; });
    EXPECT_FALSE(found);
}

/// A notice of a transition with that number, as a server sends it.
opcua::EventNotice transition(std::uint32_t number, std::int32_t reason = 1) {
    return {Kind::event,
            {opcua::Value::of(number), opcua::Value::of(UtcTime(std::chrono::seconds(7))),
             opcua::Value::of(opcua::LocalizedText{"en", "a\x1b[2Jb"}),
             opcua::Value::of(std::uint16_t{500}), opcua::Value::of(0.75),
             opcua::Value::of("id\n1"), opcua::Value::of(reason), opcua::Value::of("why")},
            {}};
}

bool any(const skill::TransitionEvent& /*event*/) {
    return true;
}

/// Entries of the log that have arrived since the mark.
std::optional<TransitionLog::Found> next(TransitionLog& log, TransitionLog::Mark from) {
    return log.await(from, std::chrono::steady_clock::now(), any).value();
}

TEST(TransitionLog, MakesTextFromTheServerPrintable) {
    TransitionLog log;
    log.add(transition(3));
    const auto event = next(log, {}).value().event;
    EXPECT_EQ(event.from, skill::State::running);
    EXPECT_EQ(event.to, skill::State::halted);
    EXPECT_EQ(event.time, UtcTime(std::chrono::seconds(7)));
    EXPECT_EQ(event.intermediate_result, skill::Value(0.75));
    EXPECT_EQ(event.severity, 500);
    EXPECT_EQ(event.message.find('\x1b'), std::string::npos);
    EXPECT_EQ(event.execution_id.find('\n'), std::string::npos);
}

TEST(TransitionLog, ANumberThatIsNoReasonIsNotTakenForAnother) {
    for (const std::int32_t number : {257, -255, 2'147'483'647, 8}) {
        TransitionLog log;
        log.add(transition(4, number));
        EXPECT_EQ(toString(next(log, {}).value().event.reason), "unknown") << number;
    }
}

TEST(TransitionLog, AnEventOfNoTransitionIsADoubt) {
    for (const std::uint32_t number : {0U, 10U, 4'294'967'295U}) {
        TransitionLog log;
        const auto before = log.mark();
        log.add(transition(number));
        EXPECT_EQ(log.mark().doubts, before.doubts + 1) << number;
        EXPECT_EQ(log.mark().number, before.number) << number;
        EXPECT_FALSE(next(log, before)) << "who waits looks for itself";
    }
}

TEST(TransitionLog, KeepsTheNewestThousandUnderTheirNumbers) {
    TransitionLog log;
    for (int i = 0; i < 1200; ++i) {
        log.add(transition(i % 2 == 0 ? 2 : 4));
    }
    EXPECT_EQ(log.mark().number, 1200U);
    EXPECT_EQ(next(log, {}).value().number, 200U);
    EXPECT_EQ(next(log, {.number = 1100}).value().number, 1100U);
    const auto halted = log.await({}, std::chrono::steady_clock::now(), [](const auto& event) {
        return event.to == skill::State::halted;
    });
    ASSERT_FALSE(halted);
    EXPECT_EQ(halted.error().status, opcua::status::kBadTimeout);
}

TEST(TransitionLog, WakesWhoWaitsByWhatComesAndByTheEnd) {
    TransitionLog log;
    const auto far = std::chrono::steady_clock::now() + std::chrono::minutes(1);
    auto waits = std::async(std::launch::async, [&] { return log.await({}, far, any); });
    log.add(transition(2));
    EXPECT_EQ(waits.get().value()->number, 0U);
    log.add(transition(4));
    auto ends = std::async(std::launch::async, [&] { return log.await({.number = 2}, far, any); });
    log.add({Kind::ended, {}, opcua::status::kBadSessionClosed});
    const auto ended = ends.get();
    ASSERT_FALSE(ended);
    EXPECT_EQ(ended.error().status, opcua::status::kBadSessionClosed);
    EXPECT_TRUE(next(log, {})) << "what came before the end is still there";
}

/// A notice with the fields that every TransitionEventType has; `to` is a name, ids are Null.
opcua::EventNotice namelessTransition(const std::string& from, const std::string& to) {
    const auto name = [](const std::string& text) {
        return opcua::Value::of(opcua::LocalizedText{"en", text});
    };
    return {Kind::event,
            {{},
             {},
             {},
             name(from),
             {},
             name(to),
             opcua::Value::of(UtcTime(std::chrono::seconds(7))),
             name("out of\nfilm"),
             opcua::Value::of(std::uint16_t{500}),
             opcua::Value::of(0.75)},
            {}};
}

TEST(NamelessTransitions, AreEventsAndDoubtsAtOnce) {
    TransitionLog log;
    Heard heard;
    log.watch(heard.watch());
    const auto before = log.mark();
    log.addNameless(namelessTransition("Running", "Halted"));
    const auto event = next(log, before).value().event;
    EXPECT_EQ(event.number, skill::TransitionNumber::running_to_halted);
    EXPECT_EQ(event.to, skill::State::halted);
    EXPECT_EQ(event.execution_id, "");
    EXPECT_EQ(event.time, UtcTime(std::chrono::seconds(7)));
    EXPECT_THAT(event.reason_text, HasSubstr("film"));
    EXPECT_EQ(event.reason_text.find('\n'), std::string::npos);
    EXPECT_EQ(event.intermediate_result, skill::Value(0.75));
    EXPECT_EQ(log.mark().doubts, before.doubts + 1);
    EXPECT_EQ(heard.transitions, 1);
    EXPECT_EQ(heard.missed, 1);
}

TEST(NamelessTransitions, MayLackTheIntermediateResult) {
    TransitionLog log;
    auto notice = namelessTransition("Ready", "Running");
    notice.fields.pop_back();
    log.addNameless(notice);
    EXPECT_EQ(next(log, {}).value().event.number, skill::TransitionNumber::ready_to_running);
}

TEST(NamelessTransitions, ThatAProgramDoesNotHaveAreDoubts) {
    TransitionLog log;
    const auto before = log.mark();
    log.addNameless(namelessTransition("Ready", "Emergency"));
    log.addNameless({Kind::event, {}, {}});
    log.addNameless({Kind::ended, {}, opcua::status::kBadTimeout});
    EXPECT_EQ(log.mark().number, before.number);
    EXPECT_EQ(log.mark().doubts, before.doubts + 3);
    EXPECT_FALSE(next(log, before)) << "its state can still be looked at";
}

TEST(NamelessTransitions, GiveTheTextOfTheNewestForItsStateAlone) {
    TransitionLog log;
    EXPECT_EQ(log.textOfLast(skill::State::halted), "");
    log.addNameless(namelessTransition("Running", "Halted"));
    EXPECT_THAT(log.textOfLast(skill::State::halted), HasSubstr("film"));
    EXPECT_EQ(log.textOfLast(skill::State::ready), "");
    log.addNameless(namelessTransition("Halted", "Ready"));
    EXPECT_EQ(log.textOfLast(skill::State::halted), "");
}

TEST(StatesWithoutEvents, AreTakenForTheTransitionsBetweenThem) {
    TransitionLog log;
    using skill::State;
    log.addState(State::ready, {});
    EXPECT_EQ(log.mark().number, 0U) << "the first is no transition";
    log.addState(State::running, {});
    log.addState(State::running, {});
    log.addState(State::halted, UtcTime(std::chrono::seconds(7)));
    log.addState(State::running, {});  // Ready between them went by unseen
    EXPECT_EQ(log.mark().number, 4U);
    const auto second = next(log, {.number = 1}).value().event;
    EXPECT_EQ(second.number, skill::TransitionNumber::running_to_halted);
    EXPECT_EQ(second.time, UtcTime(std::chrono::seconds(7)));
}

}  // namespace
}  // namespace metier::client
