#include <gmock/gmock.h>

#include <cmath>

#include "fake_robot.hpp"

namespace metier::urscript {
namespace {

using testing::AllOf;
using testing::Each;
using testing::ElementsAre;
using testing::Ge;
using testing::HasSubstr;
using testing::Le;

TEST(UrscriptMath, Functions) {
    EXPECT_EQ(resultOf("result = [sin(0), cos(0), tan(0), asin(1), acos(1), atan(1)]"),
              "[0, 1, 0, 1.5708, 0, 0.785398]");
    EXPECT_EQ(resultOf("result = [atan2(.5, .5), sqrt(9), pow(5., 3), d2r(90), r2d(1.5708)]"),
              "[0.785398, 3, 125, 1.5708, 90.0002]");
    EXPECT_EQ(resultOf("result = [ceil(1.43), floor(1.53), round(1.5), floor(-0.5)]"),
              "[2, 1, 2, -1]");
    EXPECT_EQ(resultOf("result = log(10., 4.)"), "0.60206");
    EXPECT_EQ(resultOf("result = [abs(-3), abs(-0.5), norm(-8), norm(-5.3)]"), "[3, 0.5, 8, 5.3]");
    EXPECT_EQ(resultOf("result = norm(p[-.2,.2,-.2,-1.57,0,3.14])"), "3.52768");
    EXPECT_EQ(resultOf("result = norm([3, 4])"), "5");
    EXPECT_EQ(resultOf("result = normalize([0, 1, 1])"), "[0, 0.707107, 0.707107]");
}

TEST(UrscriptMath, WhatHasNoResultIsAnException) {
    EXPECT_EQ(resultOf("acos(2)"), "2:1 acos: the argument has to be from -1 to 1");
    EXPECT_EQ(resultOf("sqrt(-1)"), "2:1 sqrt: the argument is negative");
    EXPECT_EQ(resultOf("pow(0, -1)"), "2:1 pow: there is no such power");
    EXPECT_EQ(resultOf("pow(-1, 0.5)"), "2:1 pow: there is no such power");
    EXPECT_EQ(resultOf("log(1, 2)"), "2:1 log: there is no such logarithm");
    EXPECT_EQ(resultOf("floor(1e300)"), "2:1 floor: the result is not an integer of 32 bits");
    EXPECT_EQ(resultOf("normalize([0, 0])"), "2:1 normalize: all elements are zero");
    EXPECT_EQ(resultOf("sin(\"a\")"), "2:1 sin: argument f has to be a number, not string");
}

TEST(UrscriptMath, RandomNumbersAreFromZeroToOne) {
    FakeRobot robot;
    Interpreter interpreter(parsed(within("r = [random(), random(), random(), random()]")), robot);
    interpreter.step();
    const Value random = *interpreter.variable("r");
    std::vector<double> numbers;
    for (const Value& number : random.get<List>()->elements()) {
        numbers.push_back(number.number());
    }
    EXPECT_THAT(numbers, Each(AllOf(Ge(0.0), Le(1.0))));
    EXPECT_NE(numbers[0], numbers[1]);
}

// Values of the manual's examples, rounded as there.
TEST(UrscriptPose, TransformsAsTheManualsExamples) {
    EXPECT_EQ(resultOf("result = pose_trans(p[.2,.5,.1,1.57,0,0], p[.2,.5,.6,1.57,0,0])"),
              "p[0.4, -0.0996016, 0.600478, 3.14, 0, 0]");
    EXPECT_EQ(resultOf("result = pose_inv(p[.2,.5,.1,1.57,0,3.14])"),
              "p[0.193238, 0.417943, -0.296619, 1.23993, 0, 2.47985]");
    EXPECT_EQ(resultOf("result = pose_add(p[.2,.5,.1,1.57,0,0], p[.2,.5,.6,1.57,0,0])"),
              "p[0.4, 1, 0.7, 3.14, 0, 0]");
    EXPECT_EQ(resultOf("result = pose_sub(p[.2,.5,.1,1.57,0,0], p[.2,.5,.6,1.57,0,0])"),
              "p[0, 0, -0.5, 0, 0, 0]");
    EXPECT_EQ(resultOf("result = interpolate_pose(p[.2,.2,.4,0,0,0], p[.2,.2,.6,0,0,1], .5)"),
              "p[0.2, 0.2, 0.5, 0, 0, 0.5]");
    EXPECT_EQ(resultOf("result = point_dist(p[.2,.5,.1,1.57,0,3.14], p[.2,.5,.6,0,1.57,3.14])"),
              "0.5");
    EXPECT_EQ(resultOf("result = pose_dist(p[0,0,0,0,0,0], p[3,0,0,0,0,1])"), "3.16228");
    EXPECT_EQ(resultOf("result = rotvec2rpy([3.14,1.57,0])"), "[-2.80856, -0.162024, 0.900005]");
    EXPECT_EQ(resultOf("result = rpy2rotvec([3.14,1.57,0])"), "[2.22153, 0.00176765, -2.21976]");
    EXPECT_THAT(resultOf("pose_inv([1,2,3,4,5,6])"), HasSubstr("has to be a pose, not list of 6"));
}

TEST(UrscriptText, Functions) {
    EXPECT_EQ(resultOf("result = str_cat(\"a\", str_cat(1, [0.5, True]))"), "a1[0.5, True]");
    EXPECT_EQ(resultOf("result = \"Hello\" + \", World!\""), "Hello, World!");
    EXPECT_EQ(resultOf("result = [str_len(\"abc\"), str_find(\"abcabc\", \"c\", 3), "
                       "str_find(\"a\", \"b\")]"),
              "[3, 5, -1]");
    EXPECT_EQ(resultOf("result = str_cat(str_at(\"abc\", 1), str_sub(\"abcdef\", 2, 3))"), "bcde");
    EXPECT_EQ(resultOf("result = str_sub(\"abcdef\", 4)"), "ef");
    EXPECT_EQ(resultOf("result = str_empty(\"\")"), "True");
    EXPECT_EQ(resultOf("result = to_num(\"12\") % 5"), "2");
    EXPECT_EQ(resultOf("result = to_num(\" 1.5e1 \")"), "15");
    EXPECT_EQ(resultOf("to_num(\"12a\")"), "2:1 to_num: '12a' is not a number");
    EXPECT_EQ(resultOf("to_num(\"\")"), "2:1 to_num: '' is not a number");
    EXPECT_EQ(resultOf("str_at(\"abc\", 3)"), "2:1 str_at: index 3 of a string of 3 characters");
    EXPECT_EQ(resultOf("result = to_str(p[1,2,3,0,0,0])"), "p[1, 2, 3, 0, 0, 0]");
}

TEST(UrscriptList, Functions) {
    EXPECT_EQ(resultOf("result = [get_list_length([1,2]), length(\"abc\"), length([])]"),
              "[2, 3, 0]");
    EXPECT_EQ(resultOf("result = size([[1,2],[3,4],[5,6]])"), "[3, 2]");
    EXPECT_EQ(resultOf("result = make_list(3, 0.5)"), "[0.5, 0.5, 0.5]");
    EXPECT_EQ(resultOf("result = binary_list_to_integer([True, False, False, True])"), "9");
    EXPECT_EQ(resultOf("result = binary_list_to_integer(integer_to_binary_list(-57))"), "-57");
    EXPECT_EQ(resultOf("b = integer_to_binary_list(57)\nresult = [length(b), b[0], b[1], b[5]]"),
              "[32, True, False, True]");
}

TEST(UrscriptState, GettersReadTheRobot) {
    FakeRobot robot;
    robot.now.actual_joint_position = {1, 2, 3, 4, 5, 6};
    robot.now.target_joint_velocity = {0, 0, 0, 0, 0, 0.5};
    robot.now.actual_tool_pose = {{0.1, 0.2, 0.3, 0, 0, 0}};
    robot.now.flange_from_tool = {{0, 0, 0.1, 0, 0, 0}};
    robot.now.wrench = {3, 4, 0, 0, 0, 0};
    robot.now.time = 50.5;
    EXPECT_EQ(resultOf("result = get_actual_joint_positions()", robot), "[1, 2, 3, 4, 5, 6]");
    EXPECT_EQ(resultOf("result = get_joint_positions()", robot), "[1, 2, 3, 4, 5, 6]");
    EXPECT_EQ(resultOf("result = get_target_joint_speeds()", robot), "[0, 0, 0, 0, 0, 0.5]");
    EXPECT_EQ(resultOf("result = get_actual_tcp_pose()", robot), "p[0.1, 0.2, 0.3, 0, 0, 0]");
    EXPECT_EQ(resultOf("result = get_actual_tool_flange_pose()", robot),
              "p[0.1, 0.2, 0.2, 0, 0, 0]");
    EXPECT_EQ(resultOf("result = force()", robot), "5");
    EXPECT_EQ(resultOf("result = get_steptime()", robot), "0.008");
    EXPECT_EQ(resultOf("result = time()", robot), "50.5");
    EXPECT_EQ(resultOf("result = is_steady()", robot), "True");
    EXPECT_EQ(resultOf("result = get_actual_joint_positions_history(3)", robot),
              "[-2, 2, 3, 4, 5, 6]");
    EXPECT_EQ(resultOf("result = get_joint_temp(9)", robot),
              "2:10 get_joint_temp: there is no joint 9");
    robot.contact = 7;
    EXPECT_EQ(resultOf("result = tool_contact(direction = get_tcp_force())", robot), "7");
    EXPECT_EQ(resultOf("result = tool_contact()", robot), "0");
}

TEST(UrscriptState, KinematicsAreTheRobots) {
    FakeRobot robot;
    robot.now.flange_from_tool = {{0.25, 0, 0, 0, 0, 0}};
    EXPECT_EQ(resultOf("result = get_inverse_kin(p[0.5,0,0,0,0,0], [9,1,1,1,1,1])", robot),
              "[0.25, 1, 1, 1, 1, 1]");
    EXPECT_EQ(resultOf("result = get_inverse_kin(p[0.5,0,0,0,0,0], tcp=p[0,0,0,0,0,0])", robot),
              "[0.5, 0, 0, 0, 0, 0]");
    EXPECT_EQ(resultOf("get_inverse_kin(p[1.5,0,0,0,0,0])", robot), "2:1 out of reach");
    EXPECT_EQ(resultOf("result = get_inverse_kin_has_solution(p[1.5,0,0,0,0,0])", robot), "False");
    EXPECT_EQ(resultOf("result = get_forward_kin([0.5,0,0,0,0,0])", robot),
              "p[0.75, 0, 0, 0, 0, 0]");
    EXPECT_EQ(resultOf("result = get_forward_kin()", robot), "p[0.25, 0, 0, 0, 0, 0]");
}

TEST(UrscriptState, WhereTheArmMayBeAndWhereItGoesAreTheRobots) {
    FakeRobot robot;
    robot.waypoint = {{0.4, 0, 0, 0, 0, 0}};
    robot.now.payload_inertia = {1, 2, 3, 0, 0, 0.5};
    EXPECT_EQ(resultOf("result = [is_within_safety_limits(p[0.5,0,0,0,0,0]), "
                       "is_within_safety_limits(p[1.5,0,0,0,0,0]), "
                       "is_within_safety_limits([0.5,0,0,0,0,0]), "
                       "is_within_safety_limits([1.5,0,0,0,0,0])]",
                       robot),
              "[True, False, True, False]");
    EXPECT_THAT(resultOf("is_within_safety_limits(1)"), HasSubstr("a list of 6 numbers, not int"));
    EXPECT_EQ(resultOf("result = get_target_waypoint()", robot), "p[0.4, 0, 0, 0, 0, 0]");
    EXPECT_EQ(resultOf("result = get_target_payload_inertia()", robot), "[1, 2, 3, 0, 0, 0.5]");
    EXPECT_EQ(resultOf("result = get_freedrive_status()", robot), "0");
}

TEST(UrscriptSetting, CommandsReachTheRobot) {
    FakeRobot robot;
    resultOf("set_payload(1.5, [0, 0, 0.1])", robot);
    EXPECT_EQ(robot.lastCommand<SetPayload>().mass, 1.5);
    EXPECT_THAT(*robot.lastCommand<SetPayload>().cog, ElementsAre(0, 0, 0.1));
    resultOf("set_target_payload(2, [0, 0, 0], [1, 1, 1, 0, 0, 0], 0.5)", robot);
    EXPECT_EQ(robot.lastCommand<SetTargetPayload>().transition_time, 0.5);
    resultOf("set_tcp(p[0, 0, 0.2, 0, 0, 0])", robot);
    EXPECT_EQ(robot.lastCommand<SetTcp>().flange_from_tool.value[2], 0.2);
    resultOf("set_gravity([0, 0, 9.82])", robot);
    EXPECT_EQ(robot.lastCommand<SetGravity>().gravity[2], 9.82);
    resultOf("set_tool_voltage(24000000 / 1000000)", robot);
    EXPECT_EQ(robot.lastCommand<SetToolVoltage>().voltage, 24);
    resultOf("force_mode(p[0,0,0,0,0,0], [0,0,1,0,0,0], [0,0,5,0,0,0], 2, [.1,.1,.1,1,1,1])",
             robot);
    EXPECT_EQ(robot.lastCommand<ForceMode>().wrench[2], 5);
    resultOf("force_mode_set_damping(0.5)\nforce_mode_set_gain_scaling(1.5)\nend_force_mode()",
             robot);
    EXPECT_TRUE(std::holds_alternative<EndForceMode>(robot.commands.back()));
    resultOf("freedrive_mode(freeAxes=[1,0,0,0,0,0])", robot);
    EXPECT_EQ(robot.lastCommand<FreedriveMode>().free_axes[1], 0);
    resultOf("end_freedrive_mode()\nzero_ftsensor()", robot);
    EXPECT_TRUE(std::holds_alternative<ZeroForceSensor>(robot.commands.back()));
    resultOf("ft_rtde_input_enable(True, 0.5, [0, 0, 0], [0, 0, 0.1])", robot);
    EXPECT_EQ(robot.lastCommand<ForceSensorInput>().cog[2], 0.1);
    resultOf("rtde_set_watchdog(\"input_double_register_0\", 1, \"stop\")", robot);
    EXPECT_EQ(robot.lastCommand<RtdeWatchdog>().action, "stop");
    resultOf("rtde_set_watchdog(\"input_double_register_0\", 1, \"PAUSE\")", robot);
    EXPECT_EQ(robot.lastCommand<RtdeWatchdog>().action, "pause");
    resultOf("rtde_set_watchdog(\"input_double_register_0\", 1, \"Ignore\")", robot);
    EXPECT_EQ(robot.lastCommand<RtdeWatchdog>().action, "ignore");
    resultOf("protective_stop()", robot);
    EXPECT_TRUE(std::holds_alternative<ProtectiveStop>(robot.commands.back()));
    EXPECT_THAT(resultOf("rtde_set_watchdog(\"a\", 1, \"run\")", robot),
                HasSubstr("'run' is not ignore, pause or stop"));
}

TEST(UrscriptSetting, WhatChangesNothingReachesTheRobotWithItsName) {
    FakeRobot robot;
    EXPECT_EQ(resultOf("set_tool_communication(True, 115200, 1, 2, 1.0, 3.5)\nresult = 1", robot),
              "1");
    EXPECT_EQ(robot.lastCommand<OtherCommand>().name, "set_tool_communication");
    EXPECT_EQ(robot.lastCommand<OtherCommand>().arguments.at(1).text(), "115200");
}

TEST(UrscriptRegister, ReadsInputsAndWritesOutputs) {
    FakeRobot robot;
    robot.input_integers[3] = -7;
    robot.input_floats[47] = 0.25;
    robot.bits[{RegisterBank::input, 64}] = true;
    EXPECT_EQ(resultOf("result = [read_input_integer_register(3), read_input_float_register(47), "
                       "read_input_boolean_register(64), read_input_boolean_register(65)]",
                       robot),
              "[-7, 0.25, True, False]");
    resultOf(
        "write_output_integer_register(1, 5)\nwrite_output_float_register(2, 0.5)\n"
        "write_output_boolean_register(70, True)",
        robot);
    EXPECT_EQ(resultOf("result = [read_output_integer_register(1), read_output_float_register(2), "
                       "read_output_boolean_register(70)]",
                       robot),
              "[5, 0.5, True]");
    EXPECT_EQ(resultOf("write_output_float_register(48, 1)", robot), "2:1 no register 48");
}

TEST(UrscriptInputOutput, CountsThePinsOfAllPorts) {
    FakeRobot robot;
    robot.inputs[{DigitalPort::configurable, 2}] = true;
    robot.inputs[{DigitalPort::tool, 1}] = true;
    robot.analog_inputs[{AnalogPort::tool, 1}] = 3.5;
    EXPECT_EQ(resultOf("result = [get_digital_in(10), get_configurable_digital_in(2), "
                       "get_digital_in(17), get_standard_digital_in(2), get_analog_in(3)]",
                       robot),
              "[True, True, True, False, 3.5]");
    EXPECT_EQ(resultOf("set_digital_out(16, True)\nset_standard_digital_out(2, 1)\n"
                       "result = [get_tool_digital_out(0), get_digital_out(2)]",
                       robot),
              "[True, True]");
    EXPECT_EQ(resultOf("set_standard_analog_out(1, 0.5)\nresult = get_analog_out(1)", robot),
              "0.5");
    EXPECT_EQ(resultOf("get_digital_in(99)", robot), "2:1 no pin 83");
}

TEST(UrscriptProgram, MessagesAndPopups) {
    FakeRobot robot;
    resultOf("textmsg(\"q=\", [1, 0.5])\ntextmsg(True)", robot);
    EXPECT_THAT(robot.messages, ElementsAre("q=[1, 0.5]", "True"));
    resultOf("popup(\"no\", title=\"Oh\", error = True, blocking = False)", robot);
    EXPECT_EQ(robot.popups.back().title, "Oh");
    EXPECT_EQ(robot.popups.back().level, Popup::Level::error);
}

TEST(UrscriptProgram, ABlockingPopupWaitsUntilItIsClosed) {
    FakeRobot robot;
    Interpreter interpreter(parsed("popup(\"go on?\", blocking=True)"), robot);
    interpreter.step();
    EXPECT_EQ(interpreter.step(), RunState::running);
    robot.popup_open = false;
    EXPECT_EQ(interpreter.step(), RunState::finished);
}

TEST(UrscriptMotion, FillsInTheDefaultsOfTheManual) {
    FakeRobot robot;
    resultOf("movej([1,2,3,4,5,6])", robot);
    EXPECT_EQ(std::get<Vector6>(robot.lastMotion<MoveJ>().target)[5], 6);
    EXPECT_EQ(robot.lastMotion<MoveJ>().acceleration, 1.4);
    EXPECT_EQ(robot.lastMotion<MoveJ>().velocity, 1.05);
    resultOf("movel(p[.1,0,0,0,0,0], v=0.5, r=0.01)", robot);
    EXPECT_EQ(std::get<Pose>(robot.lastMotion<MoveL>().target).value[0], 0.1);
    EXPECT_EQ(robot.lastMotion<MoveL>().acceleration, 1.2);
    EXPECT_EQ(robot.lastMotion<MoveL>().velocity, 0.5);
    EXPECT_EQ(robot.lastMotion<MoveL>().blend_radius, 0.01);
    resultOf("servoj([0,0,0,0,0,0], 0, 0, 0.008, 0.03, 2000)", robot);
    EXPECT_EQ(robot.lastMotion<ServoJ>().lookahead_time, 0.03);
    EXPECT_EQ(robot.lastMotion<ServoJ>().gain, 2000);
    resultOf("servoc(p[.1,0,0,0,0,0], r=0.01)", robot);
    EXPECT_EQ(std::get<Pose>(robot.lastMotion<ServoC>().target).value[0], 0.1);
    EXPECT_EQ(robot.lastMotion<ServoC>().acceleration, 1.2);
    EXPECT_EQ(robot.lastMotion<ServoC>().velocity, 0.25);
    resultOf("servoj([0,0,0,0,0,0], t=0.002)", robot);
    EXPECT_EQ(robot.lastMotion<ServoJ>().time, 0.002);
    EXPECT_EQ(robot.lastMotion<ServoJ>().gain, 300);
    resultOf("speedj([0,0,0,0,0,1], 40.0, 0.002)", robot);
    EXPECT_EQ(robot.lastMotion<SpeedJ>().time, 0.002);
    resultOf("speedl([0,0,0.1,0,0,0], 1.5)", robot);
    EXPECT_EQ(robot.lastMotion<SpeedL>().twist[2], 0.1);
    resultOf("movec(p[.1,0,0,0,0,0], p[.2,0,0,0,0,0], mode=1)", robot);
    EXPECT_EQ(robot.lastMotion<MoveC>().mode, 1);
    resultOf("movep(p[.1,0,0,0,0,0], a=1, v=0.1, r=0.02)", robot);
    EXPECT_EQ(robot.lastMotion<MoveP>().blend_radius, 0.02);
    resultOf("optimovej([0,0,0,0,0,0], a=0.5)\noptimovel(p[0,0,0,0,0,0], v=0.9)", robot);
    EXPECT_EQ(robot.lastMotion<OptimoveL>().velocity, 0.9);
    resultOf("direct_torque([1,0,0,0,0,0], friction_comp=False)", robot);
    EXPECT_FALSE(robot.lastMotion<DirectTorque>().friction_compensation);
    resultOf(
        "direct_torque([1,0,0,0,0,0], viscous_scale=[1,1,1,1,1,1], "
        "coulomb_scale=[.5,1,1,1,1,1])",
        robot);
    EXPECT_EQ((*robot.lastMotion<DirectTorque>().coulomb_scale)[0], 0.5);
    resultOf("stopj(4.0)\nstopl(3)", robot);
    EXPECT_EQ(robot.lastMotion<StopL>().acceleration, 3);
}

TEST(UrscriptMotion, BlocksUntilTheRobotSaysThatItIsDone) {
    FakeRobot robot;
    robot.motion_cycles = 3;
    Interpreter interpreter(parsed(within("movej([1,2,3,4,5,6])\nresult = 1")), robot);
    for (int i = 0; i < 3; ++i) {
        EXPECT_EQ(interpreter.step(), RunState::running);
    }
    EXPECT_EQ(interpreter.step(), RunState::finished);
    EXPECT_EQ(robot.abandoned, 0);
}

TEST(UrscriptMotion, WhatTheRobotRefusesIsAnException) {
    FakeRobot robot;
    robot.refusal = "protective stop";
    EXPECT_EQ(resultOf("movej([1,2,3,4,5,6])", robot), "2:1 protective stop");
}

TEST(UrscriptMotion, ASecondThreadMayNotMoveAtTheSameTime) {
    FakeRobot robot;
    robot.motion_cycles = 10;
    EXPECT_EQ(resultOf("thread t():\nmovej([0,0,0,0,0,0])\nend\nrun t()\nsync()\n"
                       "movej([1,0,0,0,0,0])",
                       robot),
              "7:1 another thread is already controlling the robot");
}

TEST(UrscriptMotion, KillingTheThreadThatMovesLetsAnotherOneMove) {
    FakeRobot robot;
    robot.motion_cycles = 10;
    EXPECT_EQ(resultOf("thread t():\nmovej([0,0,0,0,0,0])\nend\nh = run t()\nsync()\nkill h\n"
                       "stopj(4)\nresult = 1",
                       robot),
              "1");
    EXPECT_EQ(robot.abandoned, 1);
    EXPECT_EQ(robot.lastMotion<StopJ>().acceleration, 4);
}

}  // namespace
}  // namespace metier::urscript
