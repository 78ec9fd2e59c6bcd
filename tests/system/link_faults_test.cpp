// The cable between a server and its controller: cut in every state of a skill, late, or full of
// garbage. Each ends in a named state, within a stated time, and with a way back.
#include <gmock/gmock.h>

#include "arm_bench.hpp"

namespace metier::system_tests {
namespace {

using namespace std::chrono_literals;
using skill::Reason;
using skill::State;
using ::testing::HasSubstr;

void expectLost(const skill::TransitionEvent& halted) {
    EXPECT_EQ(halted.to, State::halted);
    EXPECT_EQ(halted.reason, Reason::device_lost) << halted.reason_text;
    EXPECT_THAT(halted.reason_text, HasSubstr("arm")) << "names the device";
}

class CutLink : public ::testing::TestWithParam<ArmCase> {
protected:
    ArmBench arm_{GetParam()};
};

TEST_P(CutLink, HaltsTheSkillInEveryStateAndResetBringsItBack) {
    for (const auto when :
         {When::ready, When::moving, When::suspending, When::suspended, When::resuming}) {
        SCOPED_TRACE(toString(when));
        ASSERT_NO_FATAL_FAILURE(arm_.bring(when));
        arm_.inject("cut-link");
        expectLost(arm_.haltedAfterInjection());
        EXPECT_FALSE(arm_.skill().reset()) << "nobody is there to agree";
        arm_.inject("restore-link");
        ASSERT_NO_FATAL_FAILURE(arm_.expectResetAndMove());
    }
}

TEST_P(CutLink, WhileHaltedIsToldAndRefusesReset) {
    arm_.bring(When::halted);
    arm_.inject("cut-link");
    arm_.awaitReasonText("arm: ");
    EXPECT_EQ(*arm_.skill().state(), State::halted);
    EXPECT_FALSE(arm_.skill().reset()) << "nobody is there to agree";
    arm_.inject("restore-link");
    arm_.expectResetAndMove();
}

INSTANTIATE_TEST_SUITE_P(Devices, CutLink, ::testing::ValuesIn(allArms()),
                         [](const auto& arm) { return std::string(arm.param.name); });

class LateLink : public ::testing::TestWithParam<ArmCase> {
protected:
    ArmBench arm_{GetParam()};
};

TEST_P(LateLink, WithinWhatTheDriverAllowsStopsNothing) {
    arm_.startLongMove();
    arm_.inject("delay", "100");
    arm_.awaitProgress(0.05);
    arm_.inject("restore-link");  // delayed packets come at once
    arm_.awaitProgress(0.05);
    ASSERT_TRUE(arm_.skill().halt()) << arm_.skill().reasonText();
    const auto halted = arm_.haltedAfterInjection();
    EXPECT_EQ(halted.reason, Reason::by_client) << halted.reason_text;
    arm_.expectAtRestOnTheWay();
    arm_.expectResetAndMove();
}

TEST_P(LateLink, BeyondWhatTheDriverAllowsIsALoss) {
    arm_.startLongMove();
    arm_.inject("delay", "3000");
    expectLost(arm_.haltedAfterInjection());
    if (GetParam().cut == ArmCase::Cut::stands) {
        arm_.expectAtRestOnTheWay();
    }
    arm_.inject("restore-link");
    arm_.expectResetAndMove();
}

INSTANTIATE_TEST_SUITE_P(Devices, LateLink, ::testing::ValuesIn(allArms()),
                         [](const auto& arm) { return std::string(arm.param.name); });

class GarbledLink : public ::testing::TestWithParam<ArmCase> {
protected:
    ArmBench arm_{GetParam()};
};

TEST_P(GarbledLink, HaltsAMovingArmAndMovesItNowhereElse) {
    arm_.startLongMove();
    arm_.inject("garble", "500");
    const auto halted = arm_.haltedAfterInjection();
    EXPECT_THAT(halted.reason, ::testing::AnyOf(Reason::device_lost, Reason::error));
    EXPECT_THAT(halted.reason_text, HasSubstr("arm")) << "names the device";
    arm_.expectAtRestOnTheWay();
    arm_.expectNowhereElse();
    arm_.inject("restore-link");
    arm_.expectResetAndMove();
}

TEST_P(GarbledLink, HaltsAReadySkillAndMovesNothing) {
    arm_.inject("garble", "500");
    arm_.haltedAfterInjection();
    arm_.expectNowhereElse();
    arm_.inject("restore-link");
    arm_.expectResetAndMove();
}

INSTANTIATE_TEST_SUITE_P(Devices, GarbledLink, ::testing::ValuesIn(allArms()),
                         [](const auto& arm) { return std::string(arm.param.name); });

}  // namespace
}  // namespace metier::system_tests
