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

/// Fewest joints between two links that self-collision compares.
inline constexpr std::size_t kLeastJointsBetween = 3;
/// Most capsules of a model that count.
inline constexpr std::size_t kMostCapsules = 32;

/// A cylinder with round ends around a link, for self-collision. Links whose numbers differ by less
/// than kLeastJointsBetween may overlap: they are not compared. Only the first kMostCapsules of a
/// model count.
struct Capsule {
    /// Link number: 0 is the base; i is the link behind axis i, which that axis moves.
    std::size_t link = 0;
    /// One end [m], in the joint frame of that axis, in the base frame for link 0.
    Eigen::Vector3d from;
    /// Other end [m], in the same frame.
    Eigen::Vector3d to;
    /// Radius [m], > 0.
    double radius = 0;
};

/// Two links that self-collision does not compare, by their numbers as in Capsule.
struct UncomparedLinks {
    std::size_t first = 0;
    std::size_t second = 0;
};

/// A capped cone with rounded edges to draw a link with.
struct VisualPrimitive {
    /// Link number as in Capsule.
    std::size_t link = 0;
    /// One end [m], in the frame of a Capsule of that link.
    Eigen::Vector3d from;
    /// Other end [m], in the same frame.
    Eigen::Vector3d to;
    /// Radius at `from` [m].
    double from_radius = 0;
    /// Radius at `to` [m].
    double to_radius = 0;
    /// Red, green, blue, 0 to 1.
    std::array<double, 3> color{};
    /// Rounding of both edges [m]; negative: the drawing program chooses.
    double edge = -1;
};

/// Names and shape of a kind of robot.
struct RobotAppearance {
    /// Name by which a cell file chooses it: "ur5".
    std::string name;
    /// Name of the maker: "Universal Robots".
    std::string maker;
    /// Name of the product: "UR5".
    std::string product;
    /// Shape for self-collision; empty: it is not checked.
    std::vector<Capsule> capsules;
    /// Pairs of links that are not compared, in addition to links that are close in the chain.
    std::vector<UncomparedLinks> not_compared;
    /// Shape to draw.
    std::vector<VisualPrimitive> visual;
};

/// Everything known about a kind of robot: kinematics, limits, tool frames, shape, names. Read from
/// a file of models/, or made of what a server publishes:
///
///     auto model = RobotModel::load("models/ur5.toml");
///     const Planner planner(*model);
///
/// Threading: immutable, any thread; references are valid as long as the model.
class RobotModel {
public:
    /// Reads a file of models/ (models/README.md). Waits for the disk.
    /// Errors: not_found; invalid_argument with file:line, key and reason, all errors together.
    static Result<RobotModel> load(const std::filesystem::path& path);
    /// Reads the same from text.
    /// \param name takes the place of the file in messages
    /// Errors: invalid_argument.
    static Result<RobotModel> parse(std::string_view text, const std::string& name);

    /// Makes a model of a chain alone, as a client reads it from a server. It has no shape and no
    /// names.
    /// What needs shape or names, such as the check of self-collision, is left out for it.
    /// Errors: invalid_argument (number of axes, axis not a unit vector, frames not rigid, limits,
    ///         home outside them, cycle time, name of a tool frame), with the axis.
    static Result<RobotModel> fromChain(ChainDescription chain);

    /// Copies the model with another chain of as many axes, for example the calibrated one of a
    /// controller; names and shape stay.
    /// Errors: invalid_argument (another number of axes); as fromChain().
    Result<RobotModel> withChain(ChainDescription chain) const;

    /// Names, as in RobotAppearance; empty for a chain alone.
    std::string_view name() const noexcept { return appearance_.name; }
    /// Name of the maker: "Universal Robots".
    std::string_view maker() const noexcept { return appearance_.maker; }
    /// Name of the product: "UR5".
    std::string_view product() const noexcept { return appearance_.product; }
    /// Number of axes, 1 to kMaxAxes.
    std::size_t axisCount() const noexcept { return chain_.joints.size(); }
    /// Everything that a server publishes of the robot: joints, frames, limits, tool frames.
    const ChainDescription& chain() const noexcept { return chain_; }
    /// Forward and inverse kinematics of the chain.
    const Kinematics& kinematics() const noexcept { return kinematics_; }
    /// Limits of an axis, counted from 0; `axis` must be less than axisCount(), which is not
    /// checked.
    const JointLimits& limits(std::size_t axis) const noexcept {
        return chain_.joints[axis].limits;
    }
    /// Limits of paths of the tool frame; see CartesianLimits for units.
    const CartesianLimits& cartesianLimits() const noexcept { return chain_.cartesian_limits; }
    /// A usable, non-singular working position within the limits [rad].
    const JointVector& home() const noexcept { return chain_.home; }
    /// Controller cycle [s].
    double cycleTime() const noexcept { return chain_.cycle_time; }
    /// Shape for self-collision; empty: it is not checked.
    const std::vector<Capsule>& capsules() const noexcept { return appearance_.capsules; }
    const std::vector<UncomparedLinks>& notCompared() const noexcept {
        return appearance_.not_compared;
    }
    /// Shape to draw; may be empty.
    const std::vector<VisualPrimitive>& visual() const noexcept { return appearance_.visual; }

    /// Finds a tool frame by its name; "" and "flange" are the flange itself, without mass.
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
