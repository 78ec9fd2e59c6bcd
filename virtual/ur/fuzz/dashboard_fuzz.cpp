#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "dashboard.hpp"
#include "table.hpp"

// Lines of the dashboard: as they come, and behind each command that takes an argument.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace metier::virtual_ur;
    auto& robot = table().robot;
    Dashboard dashboard(robot, [](const std::string&) {});
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    for (const auto* command :
         {"", "load ", "load /programs/", "load installation ", "popup ", "addToLog ",
          "set operational mode ", "setUserRole ", "generate support file "}) {
        const auto answer = dashboard.answer(command + std::string(text));
        if (answer.line.empty() || answer.line.size() > size + 200) {
            std::abort();
        }
    }
    robot.cycle();
    table().told.clear();
    return 0;
}
