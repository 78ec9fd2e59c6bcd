#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "metier/base/error.hpp"
#include "metier/cell/settings.hpp"
#include "metier/motion/pose.hpp"
#include "metier/virtual_controller/world_link.hpp"

namespace metier::virtual_world {

using virtual_controller::WorldEffect;
using virtual_controller::WorldReport;

/// A box that can be gripped along its x axis.
struct Part {
    Eigen::Vector3d size;           ///< [m]
    motion::Pose world_from_part;   ///< pose of its centre
    double mass = 0.0;              ///< [kg]
    std::string held_by{};          ///< controller of the gripper that holds it; empty: none
    motion::Pose jaws_from_part{};  ///< while it is held
};

/// A plane that pushes back like a spring with a damper.
struct Wall {
    Eigen::Vector3d point;       ///< a point on the plane [m]
    Eigen::Vector3d normal;      ///< unit vector, away from the wall
    double stiffness = 5'000.0;  ///< [N/m]
    double damping = 50.0;       ///< [Ns/m]
};

/// Mounting place of a controller's device.
struct Mount {
    motion::Pose world_from_base{};  ///< base of an arm
    std::string on{};  ///< for a gripper or sensor: controller of its arm; empty: the device is an
                       ///< arm
    motion::Pose flange_from_jaws{};  ///< for a gripper: frame between the jaws, x from jaw to jaw
    /// Point of an arm that touches walls first, in the flange frame [m].
    Eigen::Vector3d contact_point = Eigen::Vector3d::Zero();
};

/// Options of a world.
struct WorldOptions {
    std::map<std::string, Part> parts;
    std::map<std::string, Mount> mounts;   ///< by controller; other controllers' devices stand at
                                           ///< the origin
    std::vector<Wall> walls;               ///< a table is one, too
    std::optional<double> table_height{};  ///< height at which released parts come to rest [m]
    double part_tolerance = 0.01;          ///< a part so far from between the jaws is missed [m]
};

/// A cell without its machines: parts that move with the jaws that hold them, walls that push.
///
/// Threading: one thread.
class World {
public:
    explicit World(WorldOptions options);

    /// Takes what a controller shows, and says what the world does to its device.
    WorldEffect report(const std::string& controller, const WorldReport& report);

    /// Every part that a gripper holds falls; `gripper` empty: of all grippers.
    void drop(const std::string& gripper);
    /// Errors: not_found.
    Result<void> place(const std::string& part, const Eigen::Vector3d& position);
    /// Takes a part out of the world. Errors: not_found.
    Result<void> remove(const std::string& part);

    const std::map<std::string, Part>& parts() const noexcept { return options_.parts; }
    /// Nothing before an arm's first report.
    std::optional<motion::Pose> flangeOf(const std::string& controller) const;

private:
    struct Arm {
        motion::Pose world_from_flange;
        Eigen::Vector3d contact;  ///< contact point in the world frame [m]
        Eigen::Vector3d contact_velocity = Eigen::Vector3d::Zero();  ///< [m/s]
        double time = 0.0;  ///< its controller's own, of `contact` [s]
    };
    const Mount& mountOf(const std::string& controller) const;
    void moveArm(const std::string& controller, const motion::Pose& base_from_flange, double time);
    std::optional<double> grip(const std::string& controller, const WorldReport& report);
    bool isBetween(const motion::Pose& world_from_jaws, double jaw_width, const Part& part) const;
    void release(Part& part) const;
    motion::Wrench wrenchOn(const std::string& arm) const;

    WorldOptions options_;
    std::map<std::string, Arm> arms_;
};

/// Reads a world's settings; errors are noted in them. virtual/world/README.md lists the settings.
WorldOptions readOptions(const cell::Settings& settings);

}  // namespace metier::virtual_world
