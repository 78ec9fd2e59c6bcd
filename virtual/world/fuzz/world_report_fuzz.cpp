// A line from the world or for it; what is taken from it is finite and a rigid pose. Reports move a
// world with a part, a gripper and a wall.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "metier/virtual_controller/world_messages.hpp"
#include "world.hpp"

namespace {

using namespace metier;
using namespace metier::virtual_world;

WorldOptions smallCell() {
    WorldOptions options;
    options.parts["cube"] = {
        .size = {0.04, 0.04, 0.04}, .world_from_part = {{0.4, 0.0, 0.02}, {}}, .mass = 0.1};
    options.parts["cube"].world_from_part.rotation.setIdentity();
    options.mounts["g"].on = "a";
    options.walls.push_back({.point = {0.0, 0.0, 0.0}, .normal = {0.0, 0.0, 1.0}});
    options.table_height = 0.0;
    return options;
}

void check(bool holds) {
    if (!holds) {
        std::abort();
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    std::string_view text(reinterpret_cast<const char*>(data), size);
    World world(smallCell());
    while (!text.empty()) {
        const auto line = text.substr(0, text.find('\n'));
        text.remove_prefix(std::min(text.size(), line.size() + 1));
        if (const auto message = virtual_controller::reportOf(line)) {
            if (const auto& pose = message->report.base_from_flange) {
                check(pose->translation.allFinite());
                check(std::abs(pose->rotation.norm() - 1.0) < 1e-9);
            }
            static_cast<void>(world.report(message->name, message->report));
        }
        if (const auto effect = virtual_controller::effectOf(line)) {
            check(effect->wrench.force.allFinite() && effect->wrench.torque.allFinite());
        }
    }
    return 0;
}
