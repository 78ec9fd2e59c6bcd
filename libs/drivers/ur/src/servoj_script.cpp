#include "servoj_script.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "controller_state.hpp"

namespace metier::ur_driver {

namespace {

// Longest time from the start of the script until its token is seen in the input register.
constexpr std::chrono::milliseconds kTokenWait{500};

std::int64_t steps(std::chrono::nanoseconds time, std::chrono::nanoseconds cycle) {
    return std::max<std::int64_t>(1, time / cycle);
}

std::string positionList(std::int32_t register_base) {
    std::string list;
    for (std::size_t axis = 0; axis < kAxes; ++axis) {
        list += fmt::format("{}read_input_float_register({})", axis == 0 ? "" : ", ",
                            register_base + static_cast<std::int32_t>(axis));
    }
    return list;
}

}  // namespace

std::string servojScript(const ScriptOptions& options, std::int32_t token) {
    const std::int32_t base = options.register_base;
    std::string text = "def metier_follow():\n";
    const auto line = [&text](const std::string& statement) { text += "  " + statement + "\n"; };
    line(fmt::format("write_output_integer_register({}, {})", base, token));
    line("waited = 0");
    line(fmt::format("while (read_input_integer_register({}) != {}) and (waited < {}):", base,
                     token, steps(kTokenWait, options.cycle)));
    line("  waited = waited + 1");
    line("  sync()");
    line("end");
    line(fmt::format("counter = read_input_integer_register({})", base + 1));
    line("silent = 0");
    line(fmt::format("while (read_input_integer_register({}) == {}) and (silent < {}):", base,
                     token, steps(options.patience, options.cycle)));
    line(fmt::format("  newest = read_input_integer_register({})", base + 1));
    line("  if newest == counter:");
    line("    silent = silent + 1");
    line("  else:");
    line("    silent = 0");
    line("    counter = newest");
    line("  end");
    line(fmt::format("  write_output_integer_register({}, counter)", base + 1));
    line(fmt::format("  servoj([{}], 0, 0, {}, {}, {})", positionList(base),
                     std::chrono::duration<double>(options.cycle).count(), options.lookahead,
                     options.gain));
    line("end");
    line(fmt::format("stopj({})", options.stop_deceleration));
    line(fmt::format("write_output_integer_register({}, 0)", base));
    return text + "end\n";
}

}  // namespace metier::ur_driver
