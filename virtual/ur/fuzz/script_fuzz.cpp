#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "metier/urscript/script_splitter.hpp"
#include "table.hpp"

namespace {

// Statements that random bytes would hardly be; the input says which come, and with what numbers.
constexpr std::array kStatements{
    "servoj([{0}, -1, 1, -1, -1, {1}], 0, 0, 0.008, 0.1, 300)",
    "speedj([{0}, {1}, 0, 0, 0, 0], {1}, 0.05)",
    "speedl([{0}, 0, {1}, 0, 0, 0], 1.2, 0.05)",
    "movej([{0}, -1, 1, -1, -1, {1}], {1}, {0})",
    "movel(p[{0}, 0.3, {1}, 0, 3.1, 0], 1.2, 0.25)",
    "servoc(p[{0}, 0.3, {1}, 0, 3.1, 0], {0}, {1})",
    "protective_stop()",
    "powerdown()",
    "x = get_target_waypoint()",
    "x = is_within_safety_limits(p[{0}, {1}, 0.3, 0, 3.1, 0])",
    "x = is_within_safety_limits([{0}, {1}, 0, 0, 0, 0])",
    "stopj({0})",
    "stopl({1})",
    "set_tcp(p[{0}, 0, {1}, 0, 0, 0])",
    "set_payload({0}, [0, {1}, 0])",
    "write_output_integer_register({0}, 5)",
    "set_standard_digital_out({1}, True)",
    "x = get_inverse_kin(p[{0}, {1}, 0.3, 0, 3.1, 0])",
    "rtde_set_watchdog(\"input_int_register_0\", {0}, \"pause\")",
    "textmsg(\"x\", {0})",
    "sleep({1})",
    "set_gravity([0, {0}, 9.8])",
};

std::string statement(const char* pattern, std::uint8_t first, std::uint8_t second) {
    std::string text = pattern;
    const std::array numbers{first / 32.0 - 4.0, second / 64.0 - 1.0};
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        const auto place = "{" + std::to_string(i) + "}";
        for (auto at = text.find(place); at != std::string::npos; at = text.find(place)) {
            text.replace(at, place.size(), std::to_string(numbers[i]));
        }
    }
    return text;
}

void abortBeyondLimits(const metier::virtual_ur::Robot& robot) {
    for (std::size_t axis = 0; axis < metier::virtual_ur::kAxes; ++axis) {
        const auto& limits = robot.options().arm.limits[axis];
        if (!(std::abs(robot.state().target_q[axis]) < 7.0) ||
            !(std::abs(robot.state().target_qd[axis]) <= 1.02 * limits.velocity)) {
            std::abort();
        }
    }
}

}  // namespace

// Text of a script port: as it comes, and as a program of statements that exist. Whatever a program
// asks for, the arm stays within its limits.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace metier::virtual_ur;
    auto& robot = table().robot;
    robot.restart();
    std::string text(reinterpret_cast<const char*>(data), size);
    text += "\nend\nend\ndef made():\n";
    for (std::size_t i = 0; i + 2 < size && i < 60; i += 3) {
        text += "  " +
                statement(kStatements[data[i] % kStatements.size()], data[i + 1], data[i + 2]) +
                "\n";
    }
    text += "end\n";
    metier::urscript::ScriptSplitter splitter;
    std::vector<std::string> programs;
    (void)splitter.push(text, programs);
    for (const auto& program : programs) {
        robot.takeScript(program);
        for (int i = 0; i < 40; ++i) {
            robot.cycle();
            abortBeyondLimits(robot);
        }
    }
    table().told.clear();
    return 0;
}
