#include "servoj_script.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string_view>
#include <vector>

#include "controller_state.hpp"

namespace metier::ur_driver {

namespace {

// Longest time from the start of the script until its token is seen in the input register.
constexpr std::chrono::milliseconds kTokenWait{500};

std::int64_t steps(std::chrono::nanoseconds time, std::chrono::nanoseconds cycle) {
    return std::max<std::int64_t>(1, time / cycle);
}

constexpr std::string_view kScript = R"(def metier_follow():
  write_output_integer_register({token_register}, {token})
  waited = 0
  while (read_input_integer_register({token_register}) != {token}) and (waited < {token_wait}):
    waited = waited + 1
    sync()
  end
  counter = read_input_integer_register({counter_register})
  silent = 0
  while (read_input_integer_register({token_register}) == {token}) and (silent < {patience}):
    newest = read_input_integer_register({counter_register})
    if newest == counter:
      silent = silent + 1
    else:
      silent = 0
      counter = newest
    end
    write_output_integer_register({counter_register}, counter)
    servoj([{position}], 0, 0, {cycle}, {lookahead}, {gain})
  end
  stopj({stop_deceleration})
  write_output_integer_register({token_register}, 0)
end
)";

}  // namespace

std::string servojScript(const UrSettings& settings, std::int32_t token) {
    std::vector<std::string> position;
    for (std::size_t axis = 0; axis < kAxes; ++axis) {
        position.push_back(fmt::format("read_input_float_register({})",
                                       settings.register_base + static_cast<std::int32_t>(axis)));
    }
    using fmt::arg;
    const auto cycle = settings.cycle();
    return fmt::format(kScript, arg("token", token), arg("token_register", settings.register_base),
                       arg("counter_register", settings.register_base + 1),
                       arg("token_wait", steps(kTokenWait, cycle)),
                       arg("patience", steps(settings.receive_timeout, cycle)),
                       arg("position", fmt::join(position, ", ")),
                       arg("cycle", std::chrono::duration<double>(cycle).count()),
                       arg("lookahead", settings.servoj_lookahead),
                       arg("gain", settings.servoj_gain),
                       arg("stop_deceleration", settings.stop_deceleration));
}

}  // namespace metier::ur_driver
