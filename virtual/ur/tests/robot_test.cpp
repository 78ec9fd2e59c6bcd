#include "robot.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "robot_fixture.hpp"

namespace metier::virtual_ur {
namespace {

using testing::DoubleNear;
using testing::Pointwise;

constexpr int kText = 0;
constexpr int kSafety = 5;
constexpr int kError = 6;
constexpr int kKey = 7;
constexpr int kException = 10;

/// Script like that of RL, in our own words: follows registers while an integer is 1.
constexpr std::string_view kFollow = R"(def follow():
  while read_input_integer_register(0) == 1:
    q = [0, 0, 0, 0, 0, 0]
    i = 0
    while i < 6:
      q[i] = read_input_float_register(i)
      i = i + 1
    end
    servoj(q, 0, 0, 0.008, 0.03, 2000)
  end
end
)";

/// Writes input registers as RTDE would.
void place(RobotOnTable& table, const Vector6& q, std::int32_t run) {
    auto inputs = table.robot.rtdeInputs();
    inputs.registers.integers[0] = run;
    std::copy(q.begin(), q.end(), inputs.registers.numbers.begin());
    table.robot.inputsWritten({"input_int_register_0", "input_double_register_0"});
}

std::string textFrom(const Bytes& message, std::size_t at) {
    return {reinterpret_cast<const char*>(message.data()) + at, message.size() - at};
}

std::uint64_t timeOf(const Bytes& message) {
    ByteReader reader{std::span(message).subspan(5)};
    return reader.get<std::uint64_t>();
}

TEST(Robot, ComesUpRunningAndStandingAtItsStart) {
    RobotOnTable table("ur5", {{"start", std::vector{0.1, -1.0, 1.0, -1.0, -1.5, 0.2}}});
    const auto& state = table.robot.state();
    EXPECT_EQ(state.robot_mode, RobotMode::running);
    EXPECT_EQ(state.runtime_state, RuntimeState::stopped);
    EXPECT_GT(state.timestamp, 40.0);
    EXPECT_EQ(state.robot_status_bits, 1U);
    table.cycles(10);
    EXPECT_EQ(state.actual_q, (Vector6{0.1, -1.0, 1.0, -1.0, -1.5, 0.2}));
    EXPECT_EQ(state.joint_mode[3], 253);
}

TEST(Robot, TimestampsLieOnAnExactGrid) {
    for (const auto& [model, period] : {std::pair{"ur5", 0.008}, std::pair{"ur5e", 0.002}}) {
        RobotOnTable table(model);
        for (int i = 0; i < 1000; ++i) {
            const double before = table.robot.state().timestamp;
            table.cycles(1);
            ASSERT_NEAR(table.robot.state().timestamp - before, period, 1e-9);
        }
    }
}

TEST(Robot, TheSeriesMayBeAnotherThanTheModels) {
    const RobotOnTable e_series("ur5", {{"series", std::string("e")}});
    EXPECT_EQ(e_series.robot.rate(), 500.0);
    EXPECT_EQ(e_series.robot.options().description.version.major, 5U);
    const RobotOnTable cb3("ur5e", {{"series", std::string("cb3")}});
    EXPECT_EQ(cb3.robot.rate(), 125.0);
    EXPECT_EQ(cb3.robot.options().description.version.major, 3U);
}

TEST(Robot, ToolPoseIsThatOfTheKinematics) {
    RobotOnTable table("ur5", {{"start", std::vector{0.0, 0.0, 0.0, 0.0, 0.0, 0.0}}});
    // Stretched out; quaternion (0.7071, 0.7071, 0, 0) is a quarter turn about x.
    EXPECT_THAT(
        table.robot.state().actual_tcp_pose,
        Pointwise(DoubleNear(1e-9), Vector6{-0.81725, -0.19145, -0.005491, M_PI / 2.0, 0.0, 0.0}));
}

TEST(Robot, AStreamOfSetPointsInRegistersIsFollowed) {
    RobotOnTable table;
    const auto start = table.robot.state().target_q;
    place(table, start, 1);
    table.robot.takeScript(kFollow);
    table.cycles(2);
    EXPECT_EQ(table.robot.state().runtime_state, RuntimeState::playing);
    EXPECT_EQ(table.robot.state().robot_status_bits, 3U);
    EXPECT_TRUE(table.wasReported(kKey, "PROGRAM_XXX_STARTEDfollow"));
    Vector6 q = start;
    for (int i = 1; i <= 250; ++i) {
        q[0] = start[0] + 0.1 * (1.0 - std::cos(i * 0.008 * M_PI));
        place(table, q, 1);
        table.cycles(1);
    }
    table.cycles(50);
    EXPECT_THAT(table.robot.state().target_q, Pointwise(DoubleNear(1e-6), q));
    EXPECT_THAT(table.robot.state().actual_q, Pointwise(DoubleNear(1e-6), q));
    EXPECT_EQ(table.robot.state().safety_mode, SafetyMode::normal);

    place(table, q, 0);
    ASSERT_TRUE(table.runtimeBecomes(RuntimeState::stopped));
    EXPECT_TRUE(table.wasReported(kKey, "PROGRAM_XXX_STOPPEDfollow"));
}

TEST(Robot, ASetPointFarAwayCausesAProtectiveStopThatCanBeUnlockedLater) {
    RobotOnTable table;
    const auto start = table.robot.state().target_q;
    place(table, start, 1);
    table.robot.takeScript(kFollow);
    table.cycles(10);
    Vector6 far = start;
    far[1] += 1.0;
    place(table, far, 1);
    ASSERT_TRUE(table.until(
        [&] { return table.robot.state().safety_mode == SafetyMode::protective_stop; }, 1.0));
    EXPECT_TRUE(table.wasReported(kError, "axis 2"));
    EXPECT_TRUE(table.wasReported(kSafety, ""));
    ASSERT_TRUE(table.runtimeBecomes(RuntimeState::paused));
    EXPECT_NEAR(table.robot.state().target_q[1], start[1], 0.1);
    EXPECT_FALSE(table.robot.unlock());
    table.seconds(5.1);
    EXPECT_TRUE(table.robot.unlock());
    EXPECT_EQ(table.robot.state().safety_mode, SafetyMode::protective_stop);
    table.cycles(1);
    EXPECT_EQ(table.robot.state().safety_mode, SafetyMode::normal);
    EXPECT_EQ(table.robot.state().runtime_state, RuntimeState::paused);
    // A new program may move it again.
    place(table, table.robot.state().target_q, 1);
    table.robot.takeScript(kFollow);
    table.seconds(0.2);
    EXPECT_EQ(table.robot.state().runtime_state, RuntimeState::playing);
    EXPECT_EQ(table.robot.state().safety_mode, SafetyMode::normal);
}

TEST(Robot, AMoveThatAProtectiveStopEndedGoesOnAfterUnlockAndPlay) {
    RobotOnTable table("ur5", {{"unlock_delay", 0.0}});
    auto target = table.robot.state().target_q;
    target[0] += 0.5;
    table.robot.takeScript(
        "def m():\n  q = get_actual_joint_positions()\n  q[0] = q[0] + 0.5\n  movej(q)\nend\n");
    table.seconds(0.3);
    table.robot.protectiveStop({157, "collision detected"});
    ASSERT_TRUE(table.runtimeBecomes(RuntimeState::paused));
    ASSERT_TRUE(table.robot.unlock());
    table.cycles(1);
    ASSERT_TRUE(table.robot.play());
    ASSERT_TRUE(table.runtimeBecomes(RuntimeState::stopped));
    EXPECT_THAT(table.robot.state().target_q, Pointwise(DoubleNear(1e-6), target));
}

TEST(Robot, AMoveCanBePausedAndGoesOn) {
    RobotOnTable table;
    const double start = table.robot.state().target_q[0];
    table.robot.takeScript(
        "def m():\n  q = get_actual_joint_positions()\n  q[0] = q[0] + 0.5\n  movej(q)\nend\n");
    table.seconds(0.4);
    table.robot.programs().pause();
    ASSERT_TRUE(table.runtimeBecomes(RuntimeState::paused));
    EXPECT_EQ(table.robot.state().speed_scaling, 0.0);
    const double paused_at = table.robot.state().target_q[0];
    table.seconds(1.0);
    EXPECT_EQ(table.robot.state().target_q[0], paused_at);
    EXPECT_EQ(table.robot.state().safety_mode, SafetyMode::normal);
    ASSERT_TRUE(table.robot.play());
    ASSERT_TRUE(table.runtimeBecomes(RuntimeState::stopped));
    EXPECT_NEAR(table.robot.state().target_q[0], start + 0.5, 1e-6);
    EXPECT_EQ(table.robot.state().safety_mode, SafetyMode::normal);
}

TEST(Robot, TheSpeedSliderStretchesAMove) {
    const auto duration = [](const std::string& before) {
        RobotOnTable table;
        table.robot.takeScript(before);
        table.robot.takeScript(
            "def m():\n  q = get_actual_joint_positions()\n"
            "  q[5] = q[5] + 0.5\n  movej(q)\nend\n");
        const double start = table.robot.state().timestamp;
        EXPECT_TRUE(table.runtimeBecomes(RuntimeState::playing));
        EXPECT_TRUE(table.runtimeBecomes(RuntimeState::stopped));
        return table.robot.state().timestamp - start;
    };
    EXPECT_NEAR(duration("set speed 0.5\n"), 2.0 * duration("set speed 1\n"), 0.1);
}

TEST(Robot, ANewProgramReplacesTheRunningOne) {
    RobotOnTable table;
    table.robot.takeScript("def one():\n  while True:\n    sync()\n  end\nend\n");
    table.cycles(3);
    table.robot.takeScript("def two():\n  while True:\n    sync()\n  end\nend\n");
    table.cycles(1);
    EXPECT_TRUE(table.wasReported(kKey, "PROGRAM_XXX_STOPPEDone"));
    EXPECT_TRUE(table.wasReported(kKey, "PROGRAM_XXX_STARTEDtwo"));
    EXPECT_EQ(table.robot.state().runtime_state, RuntimeState::playing);
}

TEST(Robot, ASecondaryProgramRunsBesideThePrimaryOne) {
    RobotOnTable table;
    table.robot.takeScript("def one():\n  while True:\n    sync()\n  end\nend\n");
    table.cycles(3);
    table.robot.takeScript(
        "sec two():\n  write_output_integer_register(3, 42)\n  set_standard_digital_out(2, True)\n"
        "end\n");
    table.cycles(1);
    EXPECT_EQ(table.robot.state().outputs.integers[3], 42);
    EXPECT_EQ(table.robot.state().io.digital_outputs, 4U);
    EXPECT_EQ(table.robot.state().runtime_state, RuntimeState::playing);
}

TEST(Robot, AScriptWithAnErrorIsToldWithItsPlace) {
    RobotOnTable table;
    table.robot.takeScript("def bad():\n  txtmsg(1)\nend\n");
    ASSERT_TRUE(table.wasReported(kException, ""));
    const auto message = table.told.back();
    EXPECT_EQ(static_cast<int>(message[18]), 2);  // line
    EXPECT_EQ(static_cast<int>(message[22]), 3);  // column
    // As URCL's test_program_execution_reports_exception expects it.
    EXPECT_EQ(textFrom(message, 23), "compile_error_name_not_found:txtmsg:");
    EXPECT_TRUE(table.wasReported(kText, "line 2, column 3: function 'txtmsg' is not defined"));
    table.robot.takeScript("def late():\n  sync()\n  x = [1, 2]\n  y = x[7]\nend\n");
    ASSERT_TRUE(table.runtimeBecomes(RuntimeState::playing));
    ASSERT_TRUE(table.runtimeBecomes(RuntimeState::stopped));
    const auto& late = table.told[table.told.size() - 2];
    EXPECT_EQ(static_cast<int>(late[18]), 4);
    // Microseconds of the controller, which begins at 64 s.
    for (const auto& exception : {message, late}) {
        EXPECT_EQ(timeOf(exception) / 1'000'000, 64U);
    }
    EXPECT_EQ(timeOf(late) - timeOf(message), 16'000U);
    EXPECT_TRUE(table.wasReported(kKey, "PROGRAM_XXX_STOPPEDlate"));
}

TEST(Robot, AScriptThatIsNoneIsToldWithTheLineInTheMakersWords) {
    RobotOnTable table;
    const auto told = [&](std::string_view script) {
        table.robot.takeScript(script);
        return textFrom(table.told.back(), 23);
    };
    EXPECT_EQ(told("def u():\n    textmsg(\"log\", 1\nend\n"), "syntax_error_on_line:3:end:");
    EXPECT_EQ(told("def u():\n  movej([0.5, -1], a=1):\nend\n"),
              "syntax_error_on_line:2:  movej([0.5, -1], a=1)::");
    EXPECT_EQ(told("def u():\r\n  sleep()\r\nend\r\n"), "syntax_error_on_line:2:  sleep():");
    EXPECT_EQ(told("def u():\n  x = y\nend\n"), "compile_error_name_not_found:y:");
    EXPECT_EQ(told("def u():\n  run t()\nend\n"), "compile_error_name_not_found:t:");
    const std::string spaces(1000, ' ');
    EXPECT_EQ(told("def u():\n" + spaces + "break\nend\n"),
              "syntax_error_on_line:2:" + spaces.substr(0, 200) + ":");
    EXPECT_TRUE(table.wasReported(kText, "line 2, column 1001: 'break' outside of a loop"));
}

TEST(Robot, TextMessagesAndPopupsGoToThePrimaryPort) {
    RobotOnTable table;
    table.robot.takeScript(
        "def p():\n  textmsg(\"hello \", 5)\n  popup(\"look\", \"here\")\nend\n");
    table.cycles(2);
    EXPECT_TRUE(table.wasReported(kText, "hello 5"));
    EXPECT_TRUE(table.wasReported(2, "look"));
}

TEST(Robot, AnArmWithoutPowerRunsNoProgram) {
    RobotOnTable table("ur5", {{"powered", false}});
    table.robot.takeScript("def p():\n  sync()\nend\n");
    table.cycles(2);
    EXPECT_EQ(table.robot.state().runtime_state, RuntimeState::stopped);
    EXPECT_TRUE(table.wasReported(kText, "POWER_OFF"));
    // As URCL's primary client switches it on.
    table.robot.takeScript("power on\n");
    table.seconds(1.1);
    EXPECT_EQ(table.robot.state().robot_mode, RobotMode::idle);
    table.robot.takeScript("set robotmode run\n");
    table.seconds(0.6);
    EXPECT_EQ(table.robot.state().robot_mode, RobotMode::running);
    table.robot.takeScript("power off\n");
    table.cycles(2);
    EXPECT_EQ(table.robot.state().robot_mode, RobotMode::power_off);
}

TEST(Robot, AnArmInLocalControlTakesNoScript) {
    RobotOnTable table("ur5e", {{"remote_control", false}});
    table.robot.takeScript("def p():\n  while True:\n    sync()\n  end\nend\n");
    table.cycles(2);
    EXPECT_EQ(table.robot.state().runtime_state, RuntimeState::stopped);
    ASSERT_TRUE(table.wasReported(kError, "local control"));
    EXPECT_EQ(static_cast<int>(table.told.back()[18]), 210);
}

TEST(Robot, AnEmergencyStopEndsTheProgramAndTakesThePower) {
    RobotOnTable table;
    table.robot.takeScript("def p():\n  speedj([1, 0, 0, 0, 0, 0], 2, 20)\nend\n");
    table.seconds(0.6);
    EXPECT_NEAR(table.robot.state().target_qd[0], 1.0, 1e-6);
    table.robot.emergencyStop();
    table.cycles(1);
    EXPECT_EQ(table.robot.state().safety_mode, SafetyMode::robot_emergency_stop);
    ASSERT_TRUE(
        table.until([&] { return table.robot.state().robot_mode == RobotMode::power_off; }, 1.0));
    EXPECT_EQ(table.robot.state().runtime_state, RuntimeState::stopped);
    EXPECT_EQ(table.robot.state().target_qd, Vector6{});
}

TEST(Robot, AProgramThatEndsWhileTheArmMovesStopsIt) {
    RobotOnTable table;
    table.robot.takeScript("def p():\n  speedj([0.5, 0, 0, 0, 0, 0], 2, 0.5)\nend\n");
    ASSERT_TRUE(table.runtimeBecomes(RuntimeState::stopping));
    ASSERT_TRUE(table.runtimeBecomes(RuntimeState::stopped));
    EXPECT_EQ(table.robot.state().target_qd, Vector6{});
    EXPECT_EQ(table.robot.state().safety_mode, SafetyMode::normal);
}

TEST(Robot, TheWatchdogPausesAProgramWhoseInputIsSilent) {
    RobotOnTable table;
    table.robot.takeScript(
        "def p():\n  rtde_set_watchdog(\"input_int_register_0\", 1, \"pause\")\n"
        "  while True:\n    sync()\n  end\nend\n");
    for (int i = 0; i < 300; ++i) {
        table.robot.inputsWritten({"input_int_register_0"});
        table.cycles(1);
    }
    EXPECT_EQ(table.robot.state().runtime_state, RuntimeState::playing);
    table.seconds(0.9);
    EXPECT_EQ(table.robot.state().runtime_state, RuntimeState::playing);
    table.seconds(0.5);
    EXPECT_EQ(table.robot.state().runtime_state, RuntimeState::paused);
}

TEST(Robot, OutputsThatClientsWriteAreMasked) {
    RobotOnTable table;
    auto inputs = table.robot.rtdeInputs();
    inputs.control.standard_digital_output_mask = 0x0F;
    inputs.control.standard_digital_output = 0xF5;
    inputs.control.configurable_digital_output_mask = 0x01;
    inputs.control.configurable_digital_output = 0xFF;
    inputs.control.tool_digital_output_mask = 0xFF;
    inputs.control.tool_digital_output = 0x02;
    inputs.control.speed_slider_mask = 1;
    inputs.control.speed_slider_fraction = 0.25;
    table.robot.inputsWritten({"standard_digital_output"});
    table.cycles(1);
    EXPECT_EQ(table.robot.state().io.digital_outputs, 0x20105U);
    EXPECT_EQ(table.robot.state().speed_slider, 0.25);
}

TEST(Robot, TheWorldsWrenchIsTheForceOnTheTool) {
    RobotOnTable table("ur5e",
                       {{"start", std::vector{0.0, -M_PI / 2.0, 0.0, -M_PI / 2.0, 0.0, 0.0}}});
    table.robot.takeScript("sec t():\n  set_tcp(p[0, 0, 0.1, 0, 0, 0])\nend\n");
    table.world.given.wrench.force = {0.0, 0.0, -10.0};  // presses on the flange, in its frame
    table.world.given.wrench.force.x() = 3.0;
    table.cycles(2);
    const auto& state = table.robot.state();
    // The flange looks along -y of the base, its x along -x.
    EXPECT_NEAR(state.actual_tcp_force[1], 10.0, 1e-9);
    EXPECT_NEAR(std::abs(state.actual_tcp_force[0]), 3.0, 1e-9);
    EXPECT_NEAR(
        std::hypot(state.actual_tcp_force[3], state.actual_tcp_force[4], state.actual_tcp_force[5]),
        0.3, 1e-9);
    ASSERT_TRUE(table.world.reported.base_from_flange);
    EXPECT_GT(table.world.reported.time, 0.0);
    EXPECT_NEAR(table.world.reported.base_from_flange->translation.z(), 1.0794, 1e-9);
    table.robot.takeScript("sec z():\n  zero_ftsensor()\nend\n");
    table.cycles(2);
    EXPECT_NEAR(state.actual_tcp_force[1], 0.0, 1e-9);
}

TEST(Robot, AJointBeyondItsLimitIsAViolation) {
    RobotOnTable table;
    table.robot.exceedLimit(2);
    table.cycles(1);
    EXPECT_EQ(table.robot.state().safety_mode, SafetyMode::protective_stop);
    EXPECT_TRUE(table.wasReported(kError, "axis 3: position"));
}

TEST(Robot, AnOpenSafeguardPausesTheProgramAndAViolationEndsIt) {
    RobotOnTable table;
    table.robot.takeScript("def p():\n  sleep(100)\nend\n");
    table.cycles(2);
    table.robot.safeguardStop();
    table.cycles(100);
    EXPECT_EQ(table.robot.state().safety_mode, SafetyMode::safeguard_stop);
    EXPECT_EQ(table.robot.state().runtime_state, RuntimeState::paused);
    table.robot.closeSafeguard();
    ASSERT_TRUE(table.robot.play());
    table.cycles(100);
    EXPECT_EQ(table.robot.state().runtime_state, RuntimeState::playing);
    table.robot.violateSafety();
    table.cycles(100);
    EXPECT_EQ(table.robot.state().safety_mode, SafetyMode::violation);
    EXPECT_EQ(table.robot.state().runtime_state, RuntimeState::stopped);
    EXPECT_EQ(table.robot.state().robot_mode, RobotMode::power_off);
}

TEST(Robot, AMoveToUnreachablePoseIsARuntimeException) {
    RobotOnTable table;
    table.robot.takeScript("def p():\n  movel(p[3, 0, 0, 0, 0, 0])\nend\n");
    table.cycles(2);
    EXPECT_TRUE(table.wasReported(kException, ""));
    EXPECT_EQ(table.robot.state().safety_mode, SafetyMode::normal);
}

TEST(Robot, ARestartIsAsPowerOffAndOn) {
    RobotOnTable table;
    table.robot.takeScript("def p():\n  speedj([1, 0, 0, 0, 0, 0], 2, 20)\nend\n");
    table.seconds(1.0);
    table.robot.restart();
    EXPECT_EQ(table.robot.state().timestamp, 64.0);
    EXPECT_EQ(table.robot.state().runtime_state, RuntimeState::stopped);
    table.cycles(5);
    EXPECT_EQ(table.robot.state().robot_mode, RobotMode::running);
    EXPECT_EQ(table.robot.state().target_qd, Vector6{});
}

TEST(Robot, ModelsOfAnotherKindAndWrongSettingsAreRefused) {
    const auto iiwa = modelOf("iiwa7");
    EXPECT_FALSE(readOptions({}, iiwa));
    const auto ur5 = modelOf("ur5");
    const auto options = readOptions(
        cell::Settings("cell.toml:3: x", {{"series", std::string("f")},
                                          {"unlock_delai", 1.0},
                                          {"start", std::vector{9.0, 0.0, 0.0, 0.0, 0.0, 0.0}}}),
        ur5);
    ASSERT_FALSE(options);
    EXPECT_THAT(options.error().message,
                testing::AllOf(testing::HasSubstr("series"), testing::HasSubstr("unlock_delai"),
                               testing::HasSubstr("axis 1: 9")));
}

}  // namespace
}  // namespace metier::virtual_ur
