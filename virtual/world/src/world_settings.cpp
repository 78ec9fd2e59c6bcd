#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "metier/motion/frame.hpp"
#include "world.hpp"

namespace metier::virtual_world {
namespace {

using cell::Settings;

Eigen::Vector3d vectorAt(const std::vector<double>& values, std::size_t first) {
    return {values[first], values[first + 1], values[first + 2]};
}

motion::Pose poseIn(const std::vector<double>& v) {
    return motion::toPose({v[0], v[1], v[2], v[3], v[4], v[5]});
}

/// Calls `take` with the name and the numbers of each setting under a prefix.
template <typename Take>
void readEach(const Settings& settings, const std::string& prefix, std::size_t count, Take take) {
    for (const auto& name : settings.namesUnder(prefix)) {
        if (const auto values = settings.numbersOr(prefix + "." + name, {}, count);
            !values.empty()) {
            take(name, values);
        }
    }
}

/// x, y, z of the centre, length along x, y, z [m], mass [kg].
void readParts(const Settings& settings, WorldOptions& options) {
    readEach(settings, "part", 7, [&](const std::string& name, const auto& values) {
        if (!(std::min({values[3], values[4], values[5]}) > 0.0 && values[6] >= 0.0)) {
            settings.reject("part." + name, "lengths must be over 0 m, the mass at least 0 kg");
        }
        Part part;
        part.world_from_part.translation = vectorAt(values, 0);
        part.size = vectorAt(values, 3);
        part.mass = values[6];
        options.parts.emplace(name, std::move(part));
    });
}

/// A point, the normal, stiffness [N/m], damping [Ns/m].
void readWalls(const Settings& settings, WorldOptions& options) {
    readEach(settings, "wall", 8, [&](const std::string& name, const auto& values) {
        Wall wall{vectorAt(values, 0), vectorAt(values, 3), values[6], values[7]};
        if (!(wall.normal.norm() > 1e-6 && wall.stiffness > 0.0 && wall.damping >= 0.0)) {
            settings.reject("wall." + name,
                            "the normal must not be zero, the stiffness over 0 N/m");
            return;
        }
        wall.normal.normalize();
        options.walls.push_back(wall);
    });
}

void readMounts(const Settings& settings, WorldOptions& options) {
    readEach(settings, "base", 6, [&](const std::string& name, const auto& values) {
        options.mounts[name].world_from_base = poseIn(values);
    });
    for (const auto& name : settings.namesUnder("on")) {
        options.mounts[name].on = settings.textOr("on." + name, {});
    }
    readEach(settings, "jaws", 6, [&](const std::string& name, const auto& values) {
        options.mounts[name].flange_from_jaws = poseIn(values);
    });
    readEach(settings, "contact", 3, [&](const std::string& name, const auto& values) {
        options.mounts[name].contact_point = vectorAt(values, 0);
    });
}

}  // namespace

WorldOptions readOptions(const Settings& settings) {
    WorldOptions options;
    readParts(settings, options);
    readWalls(settings, options);
    readMounts(settings, options);
    if (settings.has("table")) {
        options.table_height = settings.numberOr("table", 0.0, -10.0, 10.0);
        options.walls.push_back(
            {{0.0, 0.0, *options.table_height}, Eigen::Vector3d::UnitZ(), 20'000.0, 200.0});
    }
    options.part_tolerance = settings.numberOr("part_tolerance", options.part_tolerance, 0.0, 0.1);
    return options;
}

}  // namespace metier::virtual_world
