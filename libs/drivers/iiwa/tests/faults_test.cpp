#include <gmock/gmock.h>

#include <cmath>
#include <cstring>
#include <string>

#include "arm_bench.hpp"

namespace metier::iiwa_driver {
namespace {

using device::EndCause;
using device::SafetyState;
using Next = device::SetPointSource::Next;
using ::testing::HasSubstr;

std::shared_ptr<Stream> endlessStream() {
    return std::make_shared<Stream>([](int, device::JointArray& set_point) {
        set_point[0] += 5e-4;
        return Next::set_point;
    });
}

TEST(IiwaFaults, NothingIsKnownBeforeTheCabinetDialsIn) {
    const auto model = iiwa7();
    const auto arm = IiwaArm::create(ArmBench::quick(), model).value();
    EXPECT_EQ(arm->state().safety, SafetyState::disconnected);
    EXPECT_THAT(arm->safety().text, HasSubstr("iiwa: not connected yet"));
    Outcome outcome;
    EXPECT_EQ(arm->move(ArmBench::toJoints(0.1), outcome.taker()).error().code,
              Errc::connection_lost);
    EXPECT_EQ(arm->resetFault().error().code, Errc::connection_lost);
}

TEST(IiwaFaults, ACabinetThatDiesWhileNothingMovesIsNoticedAndAwaitedAgain) {
    ArmBench bench;
    ASSERT_TRUE(bench.ready());
    bench.cabinet->die();
    ASSERT_TRUE(bench.becomes(SafetyState::disconnected));
    EXPECT_THAT(bench.arm->safety().text, HasSubstr("iiwa: cabinet 127.0.0.1:"));
    bench.dialIn();
    EXPECT_TRUE(bench.ready());
}

TEST(IiwaFaults, ACabinetThatDiesAtAnyCommandEndsTheMotionAndMovesNothingAfterwards) {
    for (const int code : {201, 202, 211, 102, 0}) {
        ArmBench bench({.behaviour = {.speed = 0.2}});
        ASSERT_TRUE(bench.ready());
        bench.cabinet->change([code](auto& b) { b.dies_at = code == 0 ? -1 : code; });
        Outcome outcome;
        ASSERT_TRUE(bench.arm->move(ArmBench::toJoints(2.0), outcome.taker()));
        if (code == 0) {
            ASSERT_TRUE(until([&] { return bench.cabinet->moving(); }));
            bench.cabinet->change([](auto& b) { b.dies_at = 0; });
        }
        ASSERT_TRUE(until([&] { return outcome.told(); })) << code;
        EXPECT_EQ(outcome.get().error().code, Errc::connection_lost);
        bench.dialIn();
        ASSERT_TRUE(bench.ready());
        ASSERT_TRUE(until([&] { return bench.arm->state().cycle > 50; }));
        EXPECT_THAT(bench.cabinet->codes(), ::testing::ElementsAre(305, 302, 304)) << code;
        EXPECT_EQ(outcome.count(), 1);
    }
}

TEST(IiwaFaults, ACabinetThatDiesDuringAStreamEndsIt) {
    for (const int code : {302, 102}) {
        ArmBench bench;
        ASSERT_TRUE(bench.ready());
        bench.cabinet->change([code](auto& b) { b.dies_at = code; });
        const auto stream = endlessStream();
        ASSERT_TRUE(bench.arm->attach(stream));
        ASSERT_TRUE(until([&] { return stream->ends() == 1; }));
        EXPECT_EQ(stream->cause(), EndCause::disconnected);
        EXPECT_EQ(stream->safety().state, SafetyState::disconnected);
        bench.dialIn();
        EXPECT_TRUE(bench.ready());
        EXPECT_EQ(stream->ends(), 1);
    }
}

TEST(IiwaFaults, ACabinetThatDiesWhileItIsSetUpIsAwaitedAgain) {
    ArmBench bench;
    for (const int code : {305, 302, 304}) {
        bench.cabinet->die();
        ASSERT_TRUE(bench.becomes(SafetyState::disconnected));
        bench.dialIn();
        bench.cabinet->change([code](auto& b) { b.dies_at = code; });
        ASSERT_TRUE(until([&] {
            return !bench.cabinet->ended().empty() ||
                   bench.arm->state().safety == SafetyState::normal;
        }));
    }
    bench.cabinet->die();
    ASSERT_TRUE(bench.becomes(SafetyState::disconnected));
    bench.dialIn();
    EXPECT_TRUE(bench.ready());
}

TEST(IiwaFaults, SilenceIsLossAfterTheAnswerTimeout) {
    auto options = ArmBench::quick();
    options.answer_timeout = 300ms;
    ArmBench bench({}, options);
    ASSERT_TRUE(bench.ready());
    bench.cabinet->change([](auto& b) { b.tamper = [](auto& bytes) { bytes.clear(); }; });
    ASSERT_TRUE(bench.becomes(SafetyState::disconnected));
    EXPECT_THAT(bench.arm->safety().text, HasSubstr("no answer in time"));
}

TEST(IiwaFaults, AStateThatCannotBeReadEndsTheConnection) {
    const auto put = [](std::size_t element, float value) {
        return [=](std::vector<std::byte>& bytes) {
            const auto bits = std::bit_cast<std::uint32_t>(value);
            for (std::size_t i = 0; i < 4; ++i) {
                bytes[4 * element + i] = static_cast<std::byte>(bits >> (24 - 8 * i));
            }
        };
    };
    const std::vector<std::pair<std::function<void(std::vector<std::byte>&)>, std::string>> broken{
        {put(3, std::nanf("")), "element 3 is not finite"},
        {put(24, 1e30F), "element 24"},
        {put(36, 7.0F), "neither 0 nor 1"},
        {[](auto& bytes) { bytes.resize(100); }, "no answer in time"},
        {[](auto& bytes) { bytes.resize(304); }, "double precision"},
    };
    for (const auto& [tamper, text] : broken) {
        auto options = ArmBench::quick();
        options.answer_timeout = text == "no answer in time" ? 300ms : 5s;
        ArmBench bench({}, options);
        ASSERT_TRUE(bench.ready());
        bench.cabinet->change([how = tamper](auto& b) { b.tamper = how; });
        ASSERT_TRUE(bench.becomes(SafetyState::disconnected)) << text;
        EXPECT_THAT(bench.arm->safety().text, HasSubstr(text));
        ASSERT_TRUE(until([&] { return !bench.cabinet->ended().empty(); })) << "the arm is stopped";
    }
}

TEST(IiwaFaults, AnotherPrecisionIsToldAsTheLikelyReason) {
    const auto model = iiwa7();
    const auto arm = IiwaArm::create(ArmBench::quick(), model).value();
    const ScriptedCabinet cabinet(arm->port(), {.double_precision = true});
    ASSERT_TRUE(until([&] { return !cabinet.ended().empty(); }));
    EXPECT_THAT(cabinet.ended(), HasSubstr("read 32 bytes"));
    ASSERT_TRUE(
        until([&] { return arm->safety().text.find("another precision") != std::string::npos; }));
}

TEST(IiwaFaults, NotReadyIsAProtectiveStopUntilTheCabinetIsReadyAgain) {
    ArmBench bench;
    ASSERT_TRUE(bench.ready());
    bench.cabinet->change([](auto& b) { b.ready = false; });
    ASSERT_TRUE(bench.becomes(SafetyState::protective_stop));
    EXPECT_THAT(bench.arm->resetFault().error().message, HasSubstr("not ready"));
    Outcome outcome;
    EXPECT_EQ(bench.arm->move(ArmBench::toJoints(0.1), outcome.taker()).error().code,
              Errc::device_fault);
    bench.cabinet->change([](auto& b) { b.ready = true; });
    EXPECT_TRUE(bench.ready());
    EXPECT_TRUE(bench.arm->resetFault());
}

TEST(IiwaFaults, AMotionThatIsStoppedForSafetyIsCancelledSoThatItDoesNotGoOnByItself) {
    for (const bool ready_while_moving : {true, false}) {
        ArmBench bench({.behaviour = {.speed = 0.5}});
        bench.cabinet->change([&](auto& b) { b.ready_while_moving = ready_while_moving; });
        ASSERT_TRUE(bench.ready());
        Outcome outcome;
        ASSERT_TRUE(bench.arm->move(ArmBench::toJoints(2.0), outcome.taker()));
        ASSERT_TRUE(until([&] { return bench.cabinet->position()[0] > 0.05; }));
        bench.cabinet->change([](auto& b) { b.ready = false; });
        ASSERT_TRUE(until([&] { return outcome.told(); }));
        EXPECT_THAT(outcome.get().error().message, HasSubstr("not ready to move"));
        EXPECT_EQ(bench.arm->safety().state, SafetyState::protective_stop);
        EXPECT_EQ(bench.cabinet->codes().back(), 101);
        const auto place = bench.cabinet->position();
        bench.cabinet->change([](auto& b) { b.ready = true; });
        ASSERT_TRUE(bench.ready());
        EXPECT_EQ(bench.cabinet->position(), place);
    }
}

TEST(IiwaFaults, AStreamThatIsStoppedForSafetyEnds) {
    ArmBench bench;
    ASSERT_TRUE(bench.ready());
    const auto stream = endlessStream();
    ASSERT_TRUE(bench.arm->attach(stream));
    ASSERT_TRUE(until([&] { return bench.arm->state().position[0] > 0.02; }));
    bench.cabinet->change([](auto& b) { b.ready = false; });
    ASSERT_TRUE(until([&] { return stream->ends() == 1; }));
    EXPECT_EQ(stream->cause(), EndCause::safety);
    EXPECT_EQ(stream->safety().state, SafetyState::protective_stop);
    EXPECT_FALSE(stream->safety().limit_violated);
}

TEST(IiwaFaults, AMotionThatStandsForEverIsGivenUp) {
    ArmBench bench;
    ASSERT_TRUE(bench.ready());
    bench.cabinet->change([](auto& b) { b.does_not_start = true; });
    Outcome outcome;
    ASSERT_TRUE(bench.arm->move(ArmBench::toJoints(0.5), outcome.taker()));
    ASSERT_TRUE(until([&] { return outcome.told(); }));
    EXPECT_THAT(outcome.get().error().message, HasSubstr("neither went on nor ended"));
    EXPECT_EQ(bench.cabinet->codes().back(), 101);
}

TEST(IiwaFaults, ACabinetThatRefusesItsFirstSettingsIsAFaultUntilItAcceptsThem) {
    const auto model = iiwa7();
    const auto arm = IiwaArm::create(ArmBench::quick(), model).value();
    ScriptedCabinet cabinet(arm->port(), {.behaviour = {.refused = {304}}});
    ASSERT_TRUE(until([&] { return arm->state().safety == SafetyState::fault; }));
    EXPECT_THAT(arm->safety().text, HasSubstr("control mode (304)"));
    EXPECT_FALSE(arm->resetFault());
    cabinet.change([](auto& b) { b.refused.clear(); });
    EXPECT_TRUE(until([&] { return arm->state().safety == SafetyState::normal; }));
}

TEST(IiwaFaults, AnotherArmThanTheModelDescribesIsAFault) {
    const auto model =
        motion::RobotModel::load(std::string(METIER_MODELS_DIR) + "/iiwa14.toml").value();
    const auto arm = IiwaArm::create(ArmBench::quick(), model).value();
    const ScriptedCabinet cabinet(arm->port());
    ASSERT_TRUE(until([&] { return arm->state().safety == SafetyState::fault; }));
    EXPECT_THAT(arm->safety().text, HasSubstr("another arm, or a tool"));
    Outcome outcome;
    EXPECT_FALSE(arm->move(ArmBench::toJoints(0.1), outcome.taker()));
}

TEST(IiwaFaults, ADriverThatIsShutDownTellsWhoeverMovesTheArm) {
    ArmBench bench({.behaviour = {.speed = 0.2}});
    ASSERT_TRUE(bench.ready());
    Outcome outcome;
    ASSERT_TRUE(bench.arm->move(ArmBench::toJoints(2.0), outcome.taker()));
    ASSERT_TRUE(until([&] { return bench.cabinet->moving(); }));
    bench.arm.reset();
    EXPECT_EQ(outcome.count(), 1);
    EXPECT_EQ(outcome.get().error().code, Errc::connection_lost);
    EXPECT_TRUE(until([&] { return !bench.cabinet->ended().empty(); }));
}

}  // namespace
}  // namespace metier::iiwa_driver
