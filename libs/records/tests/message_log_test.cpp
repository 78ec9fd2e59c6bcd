// What a recorder was told, until it is written.
#include "message_log.hpp"

#include "metier/base/testing/allocation_count.hpp"
#include "recorded.hpp"

namespace metier::records {
namespace {

/// Keeps what it takes.
struct Taken final : MessageTaker {
    void take(Recorder::Key key, Execution&& e) override {
        order.push_back("begin " + std::to_string(key));
        begun = std::move(e);
    }
    void take(Recorder::Key key, Transition&& t) override {
        order.push_back("transition " + std::to_string(key));
        transition = std::move(t);
    }
    void take(Recorder::Key key, Intermediate&& i) override {
        order.push_back("intermediate " + std::to_string(key));
        intermediate = std::move(i);
    }
    void take(Recorder::Key key, Outcome&& o) override {
        order.push_back("end " + std::to_string(key));
        outcome = std::move(o);
    }

    std::vector<std::string> order;
    Execution begun;
    Transition transition;
    Intermediate intermediate;
    Outcome outcome;
};

Transition stopping() {
    return {.time = at(5),
            .from = "Running",
            .to = "Running",
            .sub_state = "Stopping",
            .step = "approach",
            .reason = "ByClient",
            .reason_text = std::string("a\0b", 3)};
}

TEST(MessageLog, GivesEachMessageAsItWasPutAndInItsOrder) {
    MessageLog log;
    const auto move = moveOf("m-1", at(3));
    log.put(7, move);
    log.put(8, stopping());
    log.put(7, Intermediate{.time = at(6), .value = "0.5"});
    log.put(7, halted(at(9), "axis 2"));
    EXPECT_EQ(log.count(), 4U);
    Taken taken;
    log.giveTo(taken);
    EXPECT_THAT(taken.order,
                ::testing::ElementsAre("begin 7", "transition 8", "intermediate 7", "end 7"));
    EXPECT_EQ(taken.begun.id, "m-1");
    EXPECT_EQ(taken.begun.thumbprint, move.thumbprint);
    EXPECT_EQ(taken.begun.parameters, move.parameters);
    EXPECT_EQ(taken.begun.check, move.check);
    EXPECT_EQ(taken.begun.started, at(3));
    EXPECT_EQ(taken.transition.step, "approach");
    EXPECT_EQ(taken.transition.reason_text, std::string("a\0b", 3));
    EXPECT_EQ(taken.intermediate.value, "0.5");
    EXPECT_EQ(taken.outcome.time, at(9));
    EXPECT_EQ(taken.outcome.reason_text, "axis 2");
}

TEST(MessageLog, TellsApartWhatIsAsBeforeAndWhatIsNot) {
    MessageLog log;
    auto move = moveOf("m-1");
    move.session.assign(300, 's');
    auto other = move;
    other.user.clear();
    other.session.assign(254, 't');
    for (int round = 0; round < 2; ++round) {
        std::vector<Execution> told;
        for (const auto& one : {move, move, other, other, move}) {
            log.put(1, one);
            Taken taken;
            log.giveTo(taken);
            told.push_back(taken.begun);
        }
        const std::vector expected{move, move, other, other, move};
        for (std::size_t i = 0; i < expected.size(); ++i) {
            EXPECT_EQ(told[i].id, expected[i].id);
            EXPECT_EQ(told[i].user, expected[i].user);
            EXPECT_EQ(told[i].session, expected[i].session);
            EXPECT_EQ(told[i].parameters, expected[i].parameters);
        }
        log.clear();
    }
}

TEST(MessageLog, TellsApartMoreTextsThanItRemembers) {
    MessageLog log;
    std::vector<std::string> sessions;
    for (const int i : {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 1, 2, 9, 1, 10, 10, 3}) {
        auto move = moveOf("m-1");
        move.session = "session-" + std::to_string(i);
        sessions.push_back(move.session);
        log.put(1, move);
        Taken taken;
        log.giveTo(taken);
        EXPECT_EQ(taken.begun.session, sessions.back());
        EXPECT_EQ(taken.begun.user, move.user);
    }
}

TEST(MessageLog, TakesTwoMessagesAtOnce) {
    MessageLog log;
    log.put(3, moveOf("m-1"), stopping());
    log.put(3, stopping(), halted(at(9), "axis 2"));
    EXPECT_EQ(log.count(), 2U);
    Taken taken;
    log.giveTo(taken);
    EXPECT_THAT(taken.order,
                ::testing::ElementsAre("begin 3", "transition 3", "transition 3", "end 3"));
    EXPECT_EQ(taken.begun.user, moveOf("").user);
    EXPECT_EQ(taken.transition.step, "approach");
    EXPECT_EQ(taken.outcome.reason_text, "axis 2");
    EXPECT_EQ(taken.outcome.time, at(9));
}

TEST(MessageLog, TakesAnExecutionAsAWhole) {
    const auto move = moveOf("m-1", at(3));
    const auto end = halted(at(9), "axis 2");
    const Transition begin{.time = at(3), .from = "Ready", .to = "Running"};
    MessageLog log;
    for (Recorder::Key key = 1; key <= 2; ++key) {
        log.put(key, WholeExecution{move, begin, stopping(), end});
    }
    EXPECT_EQ(log.count(), 4U);
    Taken taken;
    log.giveTo(taken);
    EXPECT_THAT(taken.order,
                ::testing::ElementsAre("begin 1", "transition 1", "transition 1", "end 1",
                                       "begin 2", "transition 2", "transition 2", "end 2"));
    EXPECT_EQ(taken.begun.id, "m-1");
    EXPECT_EQ(taken.begun.started, at(3));
    EXPECT_EQ(taken.begun.parameters, move.parameters);
    EXPECT_EQ(taken.transition.step, "approach");
    EXPECT_EQ(taken.outcome.reason_text, "axis 2");
    EXPECT_EQ(taken.outcome.time, at(9));
}

TEST(MessageLog, HoldsMessagesOfAnySizeAndNothingOnceItIsCleared) {
    MessageLog log;
    auto large = moveOf("m-2");
    large.parameters.assign(3'000'000, 'x');
    log.put(1, moveOf("m-1"));
    log.put(2, large);
    log.put(3, moveOf("m-3"));
    Taken all;
    log.giveTo(all);
    EXPECT_THAT(all.order, ::testing::ElementsAre("begin 1", "begin 2", "begin 3"));
    log.clear();
    EXPECT_EQ(log.count(), 0U);
    log.put(4, large);
    Taken last;
    log.giveTo(last);
    EXPECT_THAT(last.order, ::testing::ElementsAre("begin 4"));
    EXPECT_EQ(last.begun.parameters, large.parameters);
}

TEST(MessageLog, AllocatesNothingOnceItHasHeldAsMuch) {
    MessageLog log;
    const auto move = moveOf("m-1");
    const auto transition = stopping();
    const auto fill = [&] {
        for (Recorder::Key key = 1; key <= 2'000; ++key) {
            log.put(key, move);
            log.put(key, transition);
        }
    };
    fill();
    log.clear();
    const auto before = allocationCount();
    fill();
    EXPECT_EQ(allocationCount() - before, 0U);
    EXPECT_EQ(log.count(), 4'000U);
}

}  // namespace
}  // namespace metier::records
