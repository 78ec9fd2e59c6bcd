// Takes any text for a URDF file and an SRDF file; a model that comes out of them can be exported
// and imported again.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "metier/robot_files/export.hpp"
#include "metier/robot_files/import.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace metier::robot_files;
    const std::string text(reinterpret_cast<const char*>(data), size);
    const auto robot = importUrdf({"a.urdf", text}, SourceFile{"a.srdf", text}, {});
    if (!robot) {
        if (robot.error().message.empty()) {
            std::abort();
        }
        return 0;
    }
    const auto exported = exportUrdf(robot->model);
    const auto again =
        importUrdf({"b.urdf", exported.urdf}, SourceFile{"b.srdf", exported.srdf}, {});
    if (!again || again->model.axisCount() != robot->model.axisCount()) {
        std::abort();
    }
    return 0;
}
