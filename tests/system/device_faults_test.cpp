// Each arm on its maker's wire: it moves, and each fault of its controller or its cable ends in a
// named state, within a stated time, with a way back.
#include <gmock/gmock.h>

#include <chrono>
#include <nlohmann/json.hpp>

#include "arm_bench.hpp"
#include "metier_program.hpp"

namespace metier::system_tests {
namespace {

using namespace std::chrono_literals;
using skill::Reason;
using skill::State;
using ::testing::HasSubstr;

class ArmOnItsWire : public ::testing::TestWithParam<ArmCase> {
protected:
    ArmBench arm_{GetParam()};
};

TEST_P(ArmOnItsWire, MovesAlongALine) {
    auto line = openSkill(arm_.client(), "CartesianLinearMoveSkill");
    for (const double x : {0.05, -0.05}) {
        const auto moved = line.run(
            {{"TargetPosition", skill::Frame{x, 0, 0, 0, 0, 0}}, {"Relative", 1}}, inAMinute());
        ASSERT_TRUE(moved) << moved.error().message;
    }
    const auto now = jointPosition(arm_.client(), arm_.skill());
    for (std::size_t axis = 0; axis < now.size(); ++axis) {
        EXPECT_NEAR(now[axis], arm_.home()[axis], 2e-3) << "axis " << axis + 1;
    }
}

TEST_P(ArmOnItsWire, IsSuspendedAndResumed) {
    arm_.startLongMove();
    ASSERT_TRUE(arm_.skill().suspend());
    ASSERT_TRUE(arm_.skill().awaitState(State::suspended, inAMinute()));
    arm_.expectAtRestOnTheWay();
    ASSERT_TRUE(arm_.skill().resume());
    EXPECT_EQ(arm_.endWithin(60s).to, State::ready);
    EXPECT_NEAR(arm_.position(), arm_.home().front() + GetParam().axis_1, 2e-3);
}

TEST_P(ArmOnItsWire, HaltsOnTheWay) {
    arm_.startLongMove();
    ASSERT_TRUE(arm_.skill().halt());
    const auto halted = arm_.endWithin(kNoticed);
    EXPECT_EQ(halted.to, State::halted);
    EXPECT_EQ(halted.reason, Reason::by_client);
    arm_.expectAtRestOnTheWay();
    arm_.expectResetAndMove();
}

TEST_P(ArmOnItsWire, IsHaltedByACutCableAndComesBack) {
    arm_.startLongMove();
    arm_.inject("cut-link");
    const auto halted = arm_.endWithin(kNoticed);
    EXPECT_EQ(halted.to, State::halted);
    EXPECT_EQ(halted.reason, Reason::device_lost);
    EXPECT_THAT(halted.reason_text, HasSubstr("arm")) << "names the device";
    if (GetParam().cut == ArmCase::Cut::stands) {
        arm_.expectAtRestOnTheWay();
    }
    EXPECT_FALSE(arm_.skill().reset()) << "nobody is there to agree";
    arm_.inject("restore-link");
    arm_.expectResetAndMove();
}

TEST_P(ArmOnItsWire, IsHaltedFromReadyByACutCable) {
    arm_.inject("cut-link");
    ASSERT_TRUE(
        arm_.skill().awaitState(State::halted, std::chrono::steady_clock::now() + kNoticed));
    const auto refused = arm_.skill().start();
    EXPECT_FALSE(refused);
    arm_.inject("restore-link");
    arm_.expectResetAndMove();
}

TEST_P(ArmOnItsWire, IsHaltedByARestartOfItsController) {
    arm_.startLongMove();
    arm_.inject("restart");
    const auto halted = arm_.endWithin(kNoticed);
    EXPECT_EQ(halted.to, State::halted);
    EXPECT_EQ(halted.reason, Reason::device_lost) << halted.reason_text;
    arm_.beginAnew();
    arm_.expectResetAndMove();
}

TEST_P(ArmOnItsWire, IsHaltedByAnEmergencyStop) {
    arm_.startLongMove();
    arm_.inject("emergency-stop");
    const auto halted = arm_.endWithin(kNoticed);
    EXPECT_EQ(halted.to, State::halted);
    EXPECT_EQ(halted.reason, Reason::error) << halted.reason_text;
    EXPECT_NE(halted.reason_text, "");
    arm_.expectAtRestOnTheWay();
    EXPECT_FALSE(arm_.skill().reset()) << "the button is still pressed";
}

TEST_P(ArmOnItsWire, IsHaltedByAStopOfItsControllerAndComesBack) {
    arm_.startLongMove();
    arm_.inject(GetParam().stop_fault);
    const auto halted = arm_.endWithin(kNoticed);
    EXPECT_EQ(halted.to, State::halted);
    EXPECT_NE(halted.reason_text, "");
    arm_.expectAtRestOnTheWay();
    arm_.expectResetAndMove();
}

INSTANTIATE_TEST_SUITE_P(Devices, ArmOnItsWire, ::testing::ValuesIn(allArms()),
                         [](const auto& arm) { return std::string(arm.param.name); });

}  // namespace
}  // namespace metier::system_tests
