#include "handover.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

namespace metier::edo_driver {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;
using State = Handover::State;

constexpr int kOther = 5;  // an algorithm state in which control is not taken

/// One handover whose robot and whose time are moved by hand.
class HandoverTest : public ::testing::Test, private Wire {
protected:
    explicit HandoverTest(const Generation& generation = externalGeneration())
        : generation_(generation) {
        handover_.begin(generation_);
    }

    void take() { handover_.take(now_, *this); }
    void giveBack() { handover_.giveBack(now_, *this); }
    void answer(ServiceResponse response) {
        response.id = fmt::format("metier-switch-{}", calls_.size());
        handover_.onResponse(response, now_);
    }
    void answer(int result) { answer({.id = {}, .ok = true, .result_code = result}); }
    /// The robot publishes its algorithm state a moment later.
    void tells(int state) {
        now_ += 1ms;
        handover_.onAlgorithmState({state}, now_);
    }
    /// Outcome after some time.
    Result<void> after(std::chrono::milliseconds time) {
        now_ += time;
        return handover_.tick(now_);
    }
    std::string problem() {
        const auto ticked = handover_.tick(now_);
        return ticked ? "" : ticked.error().message;
    }
    void taken() {
        take();
        answer(0);
        tells(generation_.taken_state);
        ASSERT_TRUE(after(0ms));
        ASSERT_EQ(handover_.state(), State::taken);
    }

    const Generation generation_;
    Handover handover_;
    SteadyTime now_{1000s};
    std::vector<std::string> calls_;

private:
    void send(std::string_view text) noexcept override { calls_.emplace_back(text); }
};

class ClassicHandover : public HandoverTest {
protected:
    ClassicHandover() : HandoverTest(classicGeneration()) {}
};

TEST_F(HandoverTest, IsDoneOnceTheAnswerAndTheAlgorithmStateAgree) {
    take();
    EXPECT_THAT(calls_.back(), HasSubstr("\"mode\":2"));
    tells(10);
    EXPECT_TRUE(after(0ms));
    EXPECT_EQ(handover_.state(), State::taking) << "no answer yet";
    answer(0);
    EXPECT_TRUE(after(0ms));
    EXPECT_EQ(handover_.state(), State::taking) << "told before the answer, it proves nothing";
    tells(10);
    EXPECT_TRUE(after(0ms));
    EXPECT_EQ(handover_.state(), State::taken);
    giveBack();
    EXPECT_THAT(calls_.back(), HasSubstr("\"mode\":0"));
    answer(0);
    tells(10);
    EXPECT_TRUE(after(0ms));
    EXPECT_EQ(handover_.state(), State::giving_back);
    tells(kOther);
    EXPECT_TRUE(after(0ms));
    EXPECT_EQ(handover_.state(), State::free);
}

TEST_F(HandoverTest, WaitsTwoSecondsForItsAnswer) {
    take();
    EXPECT_TRUE(after(1999ms));
    EXPECT_EQ(handover_.state(), State::taking);
    const auto late = after(1ms);
    ASSERT_FALSE(late);
    EXPECT_EQ(late.error().code, Errc::device_fault);
    EXPECT_EQ(late.error().message,
              "control was not handed over: no answer of the service within 2 s");
    EXPECT_EQ(handover_.state(), State::free);
    EXPECT_TRUE(after(10s)) << "told once";
}

TEST_F(HandoverTest, WaitsHalfASecondForTheAlgorithmState) {
    take();
    answer(0);
    tells(kOther);
    EXPECT_TRUE(after(498ms));
    EXPECT_THAT(after(1ms).error().message,
                HasSubstr("answered, but the algorithm state is 5 (10 while control is taken)"));
}

TEST_F(HandoverTest, BelievesARobotThatNeverToldItsAlgorithmState) {
    take();
    answer(0);
    EXPECT_TRUE(after(0ms));
    EXPECT_EQ(handover_.state(), State::taken);
}

TEST_F(HandoverTest, TellsWhyItWasRefused) {
    take();
    answer(1);
    EXPECT_EQ(problem(), "control was not handed over: refused with result 1");
    EXPECT_EQ(problem(), "");
    take();
    answer({.id = {}, .ok = false, .text = "Service /algo_control_switch_srv does not exist"});
    EXPECT_EQ(problem(),
              "control was not handed over: the service failed: Service "
              "/algo_control_switch_srv does not exist");
    take();
    answer({.id = {}, .ok = true});
    EXPECT_THAT(problem(), HasSubstr("the service failed")) << "an answer without a result";
}

TEST_F(HandoverTest, TakesNoOtherAnswerForItsOwn) {
    answer(1);
    EXPECT_EQ(problem(), "") << "nothing was asked";
    take();
    handover_.onResponse({.id = "metier-switch-7", .ok = true, .result_code = 1}, now_);
    EXPECT_EQ(problem(), "");
    answer(0);
    answer(1);
    EXPECT_EQ(problem(), "") << "the first answer counts";
    tells(10);
    EXPECT_TRUE(after(0ms));
    answer(1);
    EXPECT_EQ(problem(), "") << "it is over";
    EXPECT_EQ(handover_.state(), State::taken);
}

TEST_F(HandoverTest, ForgetsARefusalOnANewConnectionAndInTheNextCall) {
    take();
    answer(1);
    handover_.begin(generation_);
    EXPECT_EQ(handover_.state(), State::free);
    take();
    EXPECT_EQ(problem(), "");
    answer(1);
    giveBack();
    EXPECT_EQ(problem(), "");
}

TEST_F(HandoverTest, ForgetsTheAlgorithmStateOfAnotherConnection) {
    tells(kOther);
    handover_.begin(generation_);
    take();
    answer(0);
    EXPECT_TRUE(after(0ms));
    EXPECT_EQ(handover_.state(), State::taken) << "as a robot that never told it";
}

TEST_F(HandoverTest, NoticesThatControlWasTakenAway) {
    taken();
    for (int i = 0; i < 20; ++i) {
        tells(kOther);
    }
    EXPECT_EQ(problem(), "") << "states that may still be under way";
    tells(10);
    for (int i = 0; i < 20; ++i) {
        tells(kOther);
    }
    EXPECT_EQ(problem(), "");
    tells(kOther);
    EXPECT_EQ(problem(),
              "control was taken away: answered, but the algorithm state is 5 (10 while control "
              "is taken)");
    EXPECT_EQ(handover_.state(), State::free);
}

TEST_F(HandoverTest, DoesNotCountWhatWasToldBeforeControlWasTaken) {
    take();
    for (int i = 0; i < 20; ++i) {
        tells(kOther);
    }
    answer(0);
    tells(10);
    ASSERT_TRUE(after(0ms));
    for (int i = 0; i < 20; ++i) {
        tells(kOther);
    }
    EXPECT_EQ(problem(), "");
}

TEST_F(HandoverTest, ARefusalToTakeBackIsNoFailure) {
    taken();
    giveBack();
    answer(1);
    tells(kOther);
    EXPECT_EQ(problem(), "") << "a brake gave it back already";
    EXPECT_EQ(handover_.state(), State::free);
}

TEST_F(HandoverTest, TellsThatControlIsNotTakenBack) {
    taken();
    giveBack();
    answer({.id = {}, .ok = false, .text = "no"});
    EXPECT_EQ(problem(), "control was not taken back: the service failed: no");
    taken();
    giveBack();
    EXPECT_THAT(after(2s).error().message, HasSubstr("control was not taken back: no answer"));
}

TEST_F(HandoverTest, WhatAnEarlierConnectionLeftNeedNotBeThere) {
    giveBack();
    answer({.id = {}, .ok = false, .text = "no"});
    EXPECT_EQ(problem(), "");
    EXPECT_EQ(handover_.state(), State::free);
    giveBack();
    EXPECT_TRUE(after(2s)) << "no answer";
    EXPECT_EQ(handover_.state(), State::free);
}

TEST_F(ClassicHandover, TakesASilenceOfFiftyMillisecondsForTheProof) {
    tells(kOther);
    take();
    EXPECT_THAT(calls_.back(), HasSubstr("\"mode\":1"));
    EXPECT_TRUE(after(100ms));
    answer(0);
    EXPECT_TRUE(after(49ms));
    EXPECT_EQ(handover_.state(), State::taking) << "silent before the answer, it proves nothing";
    tells(kOther);
    EXPECT_TRUE(after(49ms));
    EXPECT_EQ(handover_.state(), State::taking);
    EXPECT_TRUE(after(1ms));
    EXPECT_EQ(handover_.state(), State::taken);
    giveBack();
    EXPECT_THAT(calls_.back(), HasSubstr("\"mode\":2"));
    answer(0);
    EXPECT_TRUE(after(100ms));
    EXPECT_EQ(handover_.state(), State::giving_back) << "silence is no proof of that";
    tells(kOther);
    EXPECT_TRUE(after(0ms));
    EXPECT_EQ(handover_.state(), State::free);
}

TEST_F(HandoverTest, TakesNoSilenceForAProofOfNewerSoftware) {
    tells(kOther);
    take();
    answer(0);
    EXPECT_TRUE(after(499ms));
    EXPECT_FALSE(after(1ms));
}

}  // namespace
}  // namespace metier::edo_driver
