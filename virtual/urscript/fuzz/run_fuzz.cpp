// Each byte is one word of a script, so that random inputs are mostly programs that run.
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "../tests/fake_robot.hpp"

namespace {

constexpr auto kWords = std::to_array<std::string_view>({
    "\n",
    "\n",
    "\n",
    "end\n",
    "end\n",
    "a",
    "b",
    "c",
    "a = ",
    "b = ",
    "local c = ",
    "global a = ",
    "0",
    "1",
    "2",
    "-1",
    "0.5",
    "1e300",
    "2147483647",
    "True",
    "False",
    "\"text\"",
    "(",
    ")",
    "[",
    "]",
    ", ",
    " + ",
    " - ",
    " * ",
    " / ",
    " % ",
    " == ",
    " < ",
    " >= ",
    " and ",
    " or ",
    " xor ",
    " not ",
    "-",
    "[0, 1, 2, 3, 4, 5]",
    "p[0, 0, 0, 0, 0, 0]",
    "[a]",
    "[[1, 2], [3, 4]]",
    "a[0] = ",
    "b[1, 0] = ",
    "a[b]",
    "if True:\n",
    "elif False:\n",
    "else:\n",
    "while True:\n",
    "while a < 3:\n",
    "break\n",
    "continue\n",
    "return a\n",
    "halt\n",
    "def f(x, y=1):\n",
    "f(a)",
    "f(y=b, x=a)",
    "thread t():\n",
    "a = run t()\n",
    "kill a\n",
    "join a\n",
    "enter_critical\n",
    "exit_critical\n",
    "sync()\n",
    "sleep(0.01)\n",
    "a = [a, a]\n",
    "a = str_cat(a, a)\n",
    "movej(a)\n",
    "servoj([0, 0, 0, 0, 0, 0], t=0.008)\n",
    "stopj(a)\n",
    "a = socket_open(\"h\", 1, \"s\")\n",
    "a = socket_read_binary_integer(2, \"s\", a)\n",
    "a = socket_read_string(\"s\")\n",
    "socket_send_string(a, \"s\")\n",
    "textmsg(a, b)\n",
    "a = make_list(b, a)\n",
    "a = to_str(a)\n",
    "a = str_sub(a, b)\n",
    "a = to_num(a)\n",
    "a = pose_trans(a, a)\n",
    "a = norm(a)\n",
    "a = pow(a, b)\n",
    "a = floor(a)\n",
    "a = read_input_integer_register(a)\n",
    "write_output_float_register(a, b)\n",
    "a = binary_list_to_integer(integer_to_binary_list(a))\n",
    "a = get_inverse_kin(a, b)\n",
    "popup(a, blocking=True)\n",
    "a = 1\n",
    "b = 1\n",
    "c = 1\n",
    "b = a + 1\n",
});

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace metier::urscript;
    constexpr int kCycles = 20;
    std::string text = "a = 0\nb = 1\n";
    for (std::size_t i = 0; i < size; ++i) {
        text += kWords[data[i] % kWords.size()];
    }
    // Blocks that are still open are closed, so that more inputs are programs.
    for (int end = 0; end < 4; ++end) {
        if (const auto program = Program::parse(text)) {
            FakeRobot robot;
            RunLimits limits;
            limits.instructions_per_cycle = 2000;
            Interpreter interpreter(*program, robot, limits);
            for (int cycle = 0; cycle < kCycles; ++cycle) {
                interpreter.step();
            }
            break;
        }
        text += "\nend\n";
    }
    return 0;
}
