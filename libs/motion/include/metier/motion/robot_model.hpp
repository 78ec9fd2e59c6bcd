#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "metier/base/error.hpp"
#include "metier/motion/chain.hpp"
#include "metier/motion/kinematics.hpp"

namespace metier::cell {
class TomlFile;
}

namespace metier::motion {

/// A cylinder with round ends around a link, for self-collision.
struct Capsule {
    std::size_t link = 0;  ///< 0: the base; i: the link behind axis i, which that axis moves
    Eigen::Vector3d from;  ///< one end, in the joint frame of that axis, in the base frame for link
                           ///< 0 [m]
    Eigen::Vector3d to;
    double radius = 0;  ///< [m]
};

/// A capped cone with rounded edges to draw a link with.
struct VisualPrimitive {
    std::size_t link = 0;  ///< link number as in Capsule
    Eigen::Vector3d from;
    Eigen::Vector3d to;
    double from_radius = 0;         ///< [m]
    double to_radius = 0;           ///< [m]
    std::array<double, 3> color{};  ///< red, green, blue, 0 to 1
    double edge = -1;               ///< rounding of both edges [m]; negative: the drawing program
                                    ///< chooses
};

/// Names and shape of a kind of robot.
struct RobotAppearance {
    std::string name;     ///< such as "ur5"
    std::string maker;    ///< such as "Universal Robots"
    std::string product;  ///< such as "UR5"
    std::vector<Capsule> capsules;
    std::vector<VisualPrimitive> visual;
};

/// Everything known about a kind of robot: kinematics, limits, tool frames, shape, names.
///
/// Threading: immutable, any thread.
class RobotModel {
public:
    /// Reads a file of models/ (models/README.md).
    /// Errors: not_found; invalid_argument with file:line, key and reason.
    static Result<RobotModel> load(const std::filesystem::path& path);
    /// The same from text; `name` takes the place of the file in messages.
    static Result<RobotModel> parse(std::string_view text, const std::string& name);

    /// Makes a model of a chain alone, as a client reads it from a server. It has no shape.
    /// Errors: invalid_argument (number of axes, axis not a unit vector, limits, home).
    static Result<RobotModel> fromChain(ChainDescription chain);

    /// Copies the model with another chain of as many axes, for example the calibrated one of a
    /// controller; names and shape stay. Errors: as fromChain().
    Result<RobotModel> withChain(ChainDescription chain) const;

    std::string_view name() const noexcept { return appearance_.name; }
    std::string_view maker() const noexcept { return appearance_.maker; }
    std::string_view product() const noexcept { return appearance_.product; }
    std::size_t axisCount() const noexcept { return chain_.joints.size(); }
    const ChainDescription& chain() const noexcept { return chain_; }
    const Kinematics& kinematics() const noexcept { return kinematics_; }
    const JointLimits& limits(std::size_t axis) const noexcept {
        return chain_.joints[axis].limits;
    }
    const CartesianLimits& cartesianLimits() const noexcept { return chain_.cartesian_limits; }
    const JointVector& home() const noexcept { return chain_.home; }
    /// Controller cycle [s].
    double cycleTime() const noexcept { return chain_.cycle_time; }
    const std::vector<Capsule>& capsules() const noexcept { return appearance_.capsules; }
    const std::vector<VisualPrimitive>& visual() const noexcept { return appearance_.visual; }

    /// Finds a tool frame by its name; "" and "flange" are the flange itself.
    /// Errors: not_found, with the known names.
    Result<ToolFrame> tool(std::string_view tool_name) const;

private:
    explicit RobotModel(ChainDescription chain);
    static Result<RobotModel> read(const cell::TomlFile& toml, const std::string& file_name);

    RobotAppearance appearance_;
    ChainDescription chain_;
    Kinematics kinematics_;
};

}  // namespace metier::motion
