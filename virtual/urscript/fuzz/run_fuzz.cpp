// The input decides what a program consists of, so that every input is a program that runs.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <string>
#include <string_view>

#include "../tests/fake_robot.hpp"
#include "metier/base/text.hpp"

namespace {

/// Writes a script from bytes, each of which is one decision.
class Writer {
public:
    explicit Writer(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

    std::string program() {
        std::string text = "def fuzzed():\na = 0\nb = 1\nglobal c = [0, 1]\ndef f(x, y=1):\n" +
                           block(2) + "return x\nend\nthread t():\n" + block(2) + "end\n";
        while (!bytes_.empty()) {
            text += statement(0);
        }
        return text + "end\n";
    }

private:
    std::size_t choice(std::size_t count) {
        if (bytes_.empty()) {
            return 0;
        }
        const std::size_t chosen = bytes_[0] % count;
        bytes_ = bytes_.subspan(1);
        return chosen;
    }

    template <std::size_t n>
    std::string_view oneOf(const std::array<std::string_view, n>& words) {
        return words[choice(n)];
    }

    std::string nameIn(std::string_view names) {
        const auto all = metier::split(names, ' ');
        return std::string(all[choice(all.size())]);
    }
    std::string variable() {
        return std::string(oneOf(std::to_array<std::string_view>({"a", "b", "c", "d"})));
    }

    std::string value(int depth) {
        switch (depth > 3 ? choice(3) : choice(10)) {
            case 0:
                return std::string(oneOf(std::to_array<std::string_view>(
                    {"0", "1", "-1", "2147483647", "0.5", "1e300", "31", "True", "\"text\"",
                     "\"s\"", "[]", "[0, 1, 2, 3, 4, 5]", "[[1, 2], [3, 4]]",
                     "p[0, 0, 0, 1, 2, 3]"})));
            case 1:
            case 2:
                return variable();
            case 3:
                return "[" + value(depth + 1) + ", " + value(depth + 1) + "]";
            case 4:
                return variable() + "[" + value(depth + 1) + "]";
            case 5:
                return "f(" + value(depth + 1) + ")";
            case 6:
                return call(depth);
            default:
                return "(" + value(depth + 1) + operation() + value(depth + 1) + ")";
        }
    }

    std::string operation() {
        return std::string(oneOf(std::to_array<std::string_view>(
            {" + ", " - ", " * ", " / ", " % ", " == ", " != ", " < ", " >= ", " and ", " or ",
             " xor "})));
    }

    std::string call(int depth) {
        constexpr std::string_view kOne =
            "norm floor to_str to_num str_len length size normalize sqrt inv "
            "integer_to_binary_list binary_list_to_integer read_input_float_register "
            "get_inverse_kin get_forward_kin rotvec2rpy rpy2rotvec get_digital_in "
            "socket_read_line socket_read_string tool_contact is_within_safety_limits "
            "get_joint_temp";
        constexpr std::string_view kTwo =
            "pow log atan2 str_cat str_at str_find str_sub make_list pose_trans pose_add "
            "pose_sub point_dist socket_open socket_read_binary_integer "
            "socket_read_ascii_float socket_read_byte_list socket_send_int socket_get_var";
        return choice(2) == 0
                   ? nameIn(kOne) + "(" + value(depth + 1) + ")"
                   : nameIn(kTwo) + "(" + value(depth + 1) + ", " + value(depth + 1) + ")";
    }

    std::string block(int depth) {
        std::string text;
        for (std::size_t left = choice(3); left > 0; --left) {
            text += statement(depth + 1);
        }
        return text;
    }

    std::string statement(int depth) {
        switch (depth > 3 ? choice(5) : choice(12)) {
            case 0:
            case 1:
                return variable() + " = " + value(0) + "\n";
            case 2:
                return variable() + "[" + value(1) + "] = " + value(0) + "\n";
            case 3:
                return std::string(oneOf(std::to_array<std::string_view>(
                    {"sync()\n", "a = run t()\n", "kill a\n", "join a\n", "halt\n", "sleep(a)\n",
                     "movej(c)\n", "servoc(c, b)\n", "stopj(b)\n", "popup(a, blocking=b)\n",
                     "local d = 5\n", "textmsg(a, c)\n", "set_payload(a, c)\n",
                     "enter_critical\n"})));
            case 4:
                return call(0) + "\n";
            case 5:
            case 6:
                return "if " + value(0) + ":\n" + block(depth) + "else:\n" + block(depth) + "end\n";
            case 7:
                return "while " + value(0) + ":\n" + block(depth) + "break\nend\n";
            case 8:
                return "while " + value(0) + ":\n" + block(depth) + "sync()\nend\n";
            default:
                return variable() + " = " + value(0) + "\n";
        }
    }

    std::span<const std::uint8_t> bytes_;
};

}  // namespace

/// The first byte says how much of the rest a peer sends on each socket that the program opens.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace metier::urscript;
    constexpr int kCycles = 20;
    const std::size_t sent = size == 0 ? 0 : std::min<std::size_t>(data[0] % 32, size - 1);
    const std::string received(reinterpret_cast<const char*>(data) + (size == 0 ? 0 : 1), sent);
    const std::span decisions(data + sent, size - sent);
    const auto text = Writer(decisions).program();
    const auto defined = Program::parse(text);
    if (!defined && defined.error().message.find("'d'") == std::string::npos) {
        std::abort();  // every generated text is a program, except for unset variables
    }
    if (size % 8 == 0 && Program::parse(text + "d = 1\n")) {
        std::abort();  // text behind its end
    }
    if (defined) {
        FakeRobot robot;
        robot.socket.first_received = received;
        RunLimits limits;
        limits.instructions_per_cycle = 2000;
        Interpreter interpreter(*defined, robot, limits);
        for (int cycle = 0; cycle < kCycles; ++cycle) {
            interpreter.step();
        }
    }
    return 0;
}
