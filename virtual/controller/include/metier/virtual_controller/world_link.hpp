#pragma once

#include <optional>

#include "metier/motion/pose.hpp"
#include "metier/motion/wrench.hpp"

namespace metier::virtual_controller {

/// Effect of the world on one controller's device.
struct WorldEffect {
    /// Wrench on the flange, in the flange frame [N, N m], from contact with a wall and the weight
    /// of a held part.
    motion::Wrench wrench{};
    /// Width of the part between the jaws [m]; empty: no part.
    std::optional<double> part_width{};
};

/// State of one controller's device for the world. Fields that the device does not have stay empty.
struct WorldReport {
    /// The device's own time [s], counted in cycles, however late these are calculated.
    double time = 0.0;
    /// Pose of the arm's flange in its base frame.
    std::optional<motion::Pose> base_from_flange{};
    /// Distance between a gripper's jaws [m].
    std::optional<double> jaw_width{};
    /// Whether the jaws press on a part. The part is held from then on until they are wider than
    /// it.
    bool gripping = false;
};

/// The cell around one virtual controller: arms, parts, a table, a wall.
///
/// EmptyWorld and RemoteWorld implement it.
/// Threading: the thread that runs the controller. Neither function waits.
class WorldLink {
public:
    virtual ~WorldLink() = default;

    /// Sends the present state of the device; call it once per cycle, also if all fields are empty:
    /// the world answers each report with its effect.
    virtual void report(const WorldReport& report) = 0;
    /// Newest effect, a few milliseconds old.
    /// The reference is valid as long as the link; its content may change whenever the io_context
    /// runs.
    virtual const WorldEffect& effect() const = 0;
};

}  // namespace metier::virtual_controller
