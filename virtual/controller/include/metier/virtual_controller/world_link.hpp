#pragma once

#include <optional>

#include "metier/motion/pose.hpp"
#include "metier/motion/twist.hpp"

namespace metier::virtual_controller {

/// What the world does to one controller's device.
struct WorldEffect {
    /// On the flange, in the flange frame: contact with a wall, the weight of a held part.
    motion::Wrench wrench{};
    /// Width of the part between the jaws, if there is one [m].
    std::optional<double> part_width{};
};

/// What one controller's device shows the world. What it does not have stays empty.
struct WorldReport {
    /// The device's own time [s]: its cycles, however late they are calculated.
    double time = 0.0;
    std::optional<motion::Pose> base_from_flange{};
    std::optional<double> jaw_width{};  ///< [m]
    /// The jaws press on a part. It is held from then on until they are wider than it.
    bool gripping = false;
};

/// The cell around one virtual controller: arms, parts, a table, a wall.
///
/// Threading: the thread that runs the controller. Neither function waits.
class WorldLink {
public:
    virtual ~WorldLink() = default;

    /// Call once per cycle of the device, with its present state, also if it has none: the world
    /// answers with its effect.
    virtual void report(const WorldReport& report) = 0;
    /// The newest effect; a few milliseconds old.
    virtual const WorldEffect& effect() const = 0;
};

}  // namespace metier::virtual_controller
