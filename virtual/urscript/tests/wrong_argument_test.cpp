#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <random>

#include "builtin.hpp"
#include "fake_robot.hpp"

namespace metier::urscript {
namespace {

using testing::AnyOf;
using testing::StartsWith;

struct Refusal {
    const char* statement;
    const char* message;
};

std::ostream& operator<<(std::ostream& out, const Refusal& refusal) {
    return out << refusal.statement;
}

class UrscriptRefusal : public testing::TestWithParam<Refusal> {};

TEST_P(UrscriptRefusal, NamesTheFunctionTheArgumentAndWhatItHasToBe) {
    EXPECT_EQ(resultOf(GetParam().statement), std::string("2:1 ") + GetParam().message);
}

constexpr Refusal kMotions[] = {
    {"movej(5)", "movej: argument q has to be a list of 6 numbers, not int"},
    {"movej([1, 2, 3, 4, 5, \"6\"])",
     "movej: argument q has to be a list of 6 numbers, not list of 6"},
    {"movel(p[0, 0, 0, 0, 0, 0], a=\"fast\")", "movel: argument a has to be a number, not string"},
    {"movep(p[0, 0, 0, 0, 0, 0], r=True)", "movep: argument r has to be a number, not bool"},
    {"movec(p[0, 0, 0, 0, 0, 0], [1])",
     "movec: argument pose_to has to be a list of 6 numbers, not list of 1"},
    {"movec(p[0, 0, 0, 0, 0, 0], p[0, 0, 0, 0, 0, 0], mode=1e10)",
     "movec: argument mode has to be an integer of 32 bits, not float"},
    {"servoj([0, 0, 0, 0, 0, 0], gain=True)", "servoj: argument gain has to be a number, not bool"},
    {"speedj([0, 0, 0, 0, 0, 0], [1])", "speedj: argument a has to be a number, not list of 1"},
    {"speedl(1)", "speedl: argument xd has to be a list of 6 numbers, not int"},
    {"stopj(a=[])", "stopj: argument a has to be a number, not list of 0"},
    {"direct_torque([0, 0, 0, 0, 0, 0], friction_comp=\"no\")",
     "direct_torque: argument friction_comp has to be a bool, not string"},
    {"direct_torque([0, 0, 0, 0, 0, 0], viscous_scale=1)",
     "direct_torque: argument viscous_scale has to be a list of 6 numbers, not int"},
};

constexpr Refusal kSettings[] = {
    {"set_payload(1, [0, 0])",
     "set_payload: argument cog has to be a list of 3 numbers, not list of 2"},
    {"set_payload_cog(0.1)",
     "set_payload_cog: argument CoG has to be a list of 3 numbers, not float"},
    {"set_target_payload(1, [0, 0, 0], [1])",
     "set_target_payload: argument inertia has to be a list of 6 numbers, not list of 1"},
    {"set_gravity(p[0, 0, 0, 0, 0, 0])",
     "set_gravity: argument d has to be a list of 3 numbers, not pose"},
    {"force_mode([0, 0, 0, 0, 0, 0], [0, 0, 0, 0, 0, 0], [0, 0, 0, 0, 0, 0], 2, [0, 0, 0, 0, 0, "
     "0])",
     "force_mode: argument task_frame has to be a pose, not list of 6"},
    {"set_tool_voltage(\"24V\")",
     "set_tool_voltage: argument voltage has to be a number, not string"},
    {"rtde_set_watchdog(1, 1)",
     "rtde_set_watchdog: argument variable_name has to be a string, not int"},
    {"rtde_set_watchdog(\"a\", 1, 2)",
     "rtde_set_watchdog: argument action has to be a string, not int"},
    {"ft_rtde_input_enable(\"yes\")",
     "ft_rtde_input_enable: argument enable has to be a bool, not string"},
    {"set_digital_out(1, \"on\")", "set_digital_out: argument b has to be a bool, not string"},
    {"set_standard_analog_out(0, True)",
     "set_standard_analog_out: argument f has to be a number, not bool"},
    {"get_digital_in(\"0\")", "get_digital_in: argument n has to be a number, not string"},
    {"write_output_integer_register(0, 3000000000)",
     "write_output_integer_register: argument value has to be an integer of 32 bits, not float"},
    {"write_output_boolean_register(0, p[0, 0, 0, 0, 0, 0])",
     "write_output_boolean_register: argument value has to be a bool, not pose"},
    {"read_input_float_register(True)",
     "read_input_float_register: argument address has to be a number, not bool"},
};

constexpr Refusal kSocketsAndText[] = {
    {"socket_open(10, 20)", "socket_open: argument address has to be a string, not int"},
    {"socket_open(\"h\", 65536)", "socket_open: port 65536 is not from 1 to 65535"},
    {"socket_close(0)", "socket_close: argument socket_name has to be a string, not int"},
    {"socket_read_line(5)", "socket_read_line: argument socket_name has to be a string, not int"},
    {"socket_read_byte_list(0)", "socket_read_byte_list: number 0 is not from 1 to 30"},
    {"socket_read_string(interpret_escape=\"yes\")",
     "socket_read_string: argument interpret_escape has to be a bool, not string"},
    {"socket_set_var(\"a\", \"b\")",
     "socket_set_var: argument value has to be a number, not string"},
    {"popup(\"a\", 5)", "popup: argument title has to be a string, not int"},
    {"str_len(5)", "str_len: argument str has to be a string, not int"},
    {"str_sub(\"abc\", -1)", "str_sub: index -1 of a string of 3 characters"},
    {"str_sub(\"\", 0)", "str_sub: index 0 of a string of 0 characters"},
    {"str_find(\"a\", \"a\", -1)", "str_find: the start is negative"},
    {"to_num(5)", "to_num: argument str has to be a string, not int"},
};

constexpr Refusal kLists[] = {
    {"length(5)", "length: argument v has to be a list, not int"},
    {"size(p[0, 0, 0, 0, 0, 0])", "size: argument v has to be a list, not pose"},
    {"make_list(-1, 0)", "make_list: the length has to be from 0 to 100000"},
    {"make_list(2, [1])", "make_list: a list of lists is not possible"},
    {"binary_list_to_integer([1])", "binary_list_to_integer: the elements have to be bools"},
    {"norm([1, \"a\"])", "norm: the elements have to be numbers"},
    {"normalize([0, True])", "normalize: the elements have to be numbers"},
    {"rotvec2rpy([1, 2])",
     "rotvec2rpy: argument rotation_vector has to be a list of 3 numbers, not list of 2"},
    {"interpolate_pose(p[0, 0, 0, 0, 0, 0], p[0, 0, 0, 0, 0, 0], \"half\")",
     "interpolate_pose: argument alpha has to be a number, not string"},
    {"pose_dist(p[0, 0, 0, 0, 0, 0], [0, 0, 0, 0, 0, 0])",
     "pose_dist: argument p_to has to be a pose, not list of 6"},
    {"get_inverse_kin(p[0, 0, 0, 0, 0, 0], qnear=5)",
     "get_inverse_kin: argument qnear has to be a list of 6 numbers, not int"},
    {"get_inverse_kin_has_solution([0, 0, 0, 0, 0, 0])",
     "get_inverse_kin_has_solution: argument x has to be a pose, not list of 6"},
    {"get_forward_kin(5)", "get_forward_kin: argument q has to be a list of 6 numbers, not int"},
    {"get_joint_temp(-1)", "get_joint_temp: there is no joint -1"},
    {"tool_contact(1)", "tool_contact: argument direction has to be a list of 6 numbers, not int"},
};

INSTANTIATE_TEST_SUITE_P(Motions, UrscriptRefusal, testing::ValuesIn(kMotions));
INSTANTIATE_TEST_SUITE_P(Settings, UrscriptRefusal, testing::ValuesIn(kSettings));
INSTANTIATE_TEST_SUITE_P(SocketsAndText, UrscriptRefusal, testing::ValuesIn(kSocketsAndText));
INSTANTIATE_TEST_SUITE_P(Lists, UrscriptRefusal, testing::ValuesIn(kLists));

std::vector<const Builtin*> allBuiltins() {
    std::vector<const Builtin*> all;
    for (const auto group :
         {mathBuiltins(), poseBuiltins(), textBuiltins(), listBuiltins(), stateBuiltins(),
          motionBuiltins(), settingBuiltins(), registerBuiltins(), inputOutputBuiltins(),
          socketBuiltins(), programBuiltins()}) {
        for (const Builtin& builtin : group) {
            all.push_back(&builtin);
        }
    }
    return all;
}

std::size_t parameterCount(const Builtin& builtin) {
    return builtin.parameters.empty()
               ? 0
               : 1 + static_cast<std::size_t>(
                         std::count(builtin.parameters.begin(), builtin.parameters.end(), ' '));
}

std::string callOf(const Builtin& builtin, const std::vector<std::string>& arguments) {
    return fmt::format("{}({})", builtin.name, fmt::join(arguments, ", "));
}

TEST(UrscriptBuiltin, EachOneNeedsItsArguments) {
    for (const Builtin* builtin : allBuiltins()) {
        if (builtin->required == 0) {
            EXPECT_EQ(parseError(callOf(*builtin, {})), "") << builtin->name;
            continue;
        }
        const auto first = builtin->parameters.substr(0, builtin->parameters.find(' '));
        EXPECT_EQ(
            parseError(callOf(*builtin, {})),
            fmt::format("line 1, column 1: {} needs an argument for '{}'", builtin->name, first));
        const std::vector<std::string> given(builtin->required - 1U, "1");
        EXPECT_THAT(parseError(callOf(*builtin, given)),
                    testing::HasSubstr("needs an argument for"))
            << builtin->name;
    }
}

TEST(UrscriptBuiltin, EachOneRefusesArgumentsThatItDoesNotHave) {
    for (const Builtin* builtin : allBuiltins()) {
        const std::size_t most = parameterCount(*builtin);
        EXPECT_EQ(parseError(callOf(*builtin, std::vector<std::string>(most, "1"))), "");
        EXPECT_EQ(parseError(callOf(*builtin, std::vector<std::string>(most + 1, "1"))),
                  fmt::format("line 1, column {}: {} takes at most {} arguments",
                              builtin->name.size() + 2 + 3 * most, builtin->name, most));
        EXPECT_EQ(parseError(callOf(*builtin, {"nothing=1"})),
                  fmt::format("line 1, column {}: {} has no parameter 'nothing'",
                              builtin->name.size() + 2, builtin->name));
    }
}

/// Whether a script has done something that others can see.
bool didSomething(const FakeRobot& robot) {
    return !robot.motions.empty() || !robot.commands.empty() || !robot.messages.empty() ||
           !robot.popups.empty() || !robot.outputs.empty() || !robot.analog_outputs.empty() ||
           !robot.socket.all.empty();
}

/// Runs a call on a robot of its own until it ends; popups are closed at once.
void expectAnOrderlyEnd(const Builtin& builtin, const std::string& call) {
    constexpr int kMostCycles = 1000;
    FakeRobot robot;
    Interpreter interpreter(parsed(within("def none():\nend\n" + call)), robot);
    for (int i = 0; i < kMostCycles && interpreter.step() == RunState::running; ++i) {
        robot.popup_open = false;
    }
    EXPECT_TRUE(interpreter.state() != RunState::running || builtin.name == "sleep") << call;
    if (const auto& exception = interpreter.exception()) {
        EXPECT_EQ(exception->line, 4) << call;
        EXPECT_THAT(exception->text,
                    AnyOf(StartsWith(fmt::format("{}: ", builtin.name)), StartsWith("no register"),
                          StartsWith("no pin"), StartsWith("out of reach")))
            << call;
        EXPECT_FALSE(didSomething(robot)) << call;
    }
}

TEST(UrscriptBuiltin, ACallThatFailsDoesNothingWhateverItsArgumentsAre) {
    const std::vector<std::string> values{"none()",
                                          "True",
                                          "-1",
                                          "7",
                                          "0.5",
                                          "1e300",
                                          "\"\"",
                                          "\"x\"",
                                          "[]",
                                          "[1, 2, 3]",
                                          "[True]",
                                          "[[1]]",
                                          "[1, 2, 3, 4, 5, 6]",
                                          "p[1, 2, 3, 4, 5, 6]"};
    constexpr int kCallsOfEach = 40;
    std::mt19937 random(7);  // NOLINT: the same calls at each run
    const auto below = [&](std::size_t count) {
        return std::uniform_int_distribution<std::size_t>(0, count - 1)(random);
    };
    for (const Builtin* builtin : allBuiltins()) {
        const std::size_t optional = parameterCount(*builtin) - builtin->required;
        for (int i = 0; i < kCallsOfEach; ++i) {
            std::vector<std::string> arguments(builtin->required + below(optional + 1));
            for (auto& argument : arguments) {
                argument = values[below(values.size())];
            }
            expectAnOrderlyEnd(*builtin, callOf(*builtin, arguments));
        }
    }
}

}  // namespace
}  // namespace metier::urscript
