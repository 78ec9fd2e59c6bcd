#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "metier/motion/robot_model.hpp"
#include "metier/skill/field_list.hpp"

namespace metier::robot_skills {

/// What the target is relative to: RelativeMode of the NodeSet.
enum class Relative : std::int32_t {
    absolute = 0,  ///< a pose in the base frame, or a joint position
    base = 1,      ///< added to the start along the base axes, or to its joint position
    tool = 2,      ///< added to the start along the axes of the tool frame; poses only
};

/// What every move takes, whatever its target.
struct MoveParameters {
    std::string tool_frame{};                  ///< "": the flange
    std::vector<double> max_velocity{};        ///< all zero: the robot's own
    std::vector<double> max_acceleration{};    ///< all zero: the robot's own
    std::int32_t relative = 0;                 ///< a Relative
    double blend_radius = 0.0;                 ///< [m]
    double speed_override = 1.0;               ///< (0, 1]
    std::optional<double> redundancy_angle{};  ///< [rad]
    std::optional<double> duration{};          ///< of the motion [s]; none: as short as can be
    /// When it begins, by the clock of whoever runs it [s since 1970-01-01 UTC]; none: at once.
    std::optional<double> start_time{};
    /// Length of a Suspend [s], in which all arms of a common motion brake along their planned
    /// times; none: as short as the arm's own limits allow.
    std::optional<double> stop_time{};
};

/// A move to a pose.
struct CartesianMoveParameters : MoveParameters {
    skill::Frame target_position;             ///< of the tool frame
    std::vector<skill::Range> axis_bounds{};  ///< [rad]; all zero: the robot's own
};

/// A move to a pose that a contact force ends.
struct ForceMoveParameters : CartesianMoveParameters {
    skill::Vector3 max_force;    ///< along x, y, z of the base frame [N]; 0: no limit
    bool halt_on_force = false;  ///< a force over its limit is an error: Halted, not Ready
};

/// A move along lines through several poses, corners rounded.
struct PathMoveParameters : MoveParameters {
    std::vector<skill::Frame> poses{};  ///< of the tool frame, at least one
    /// How far from its pose each corner may be cut, > 0 [m]; one per pose, the last is not used.
    std::vector<double> blend_radii{};
    std::vector<double> speeds{};  ///< largest on the way to each pose [m/s]; 0, or empty: no own
};

/// A move to a joint position.
struct JointMoveParameters : MoveParameters {
    std::vector<double> target_joint_position{};  ///< [rad]
};

/// What a move tells when it is done.
struct MoveResults {
    skill::Frame reached_pose;                     ///< base_from_tool, measured
    std::vector<double> reached_joint_position{};  ///< measured [rad]
    double duration = 0.0;                         ///< in motion, without the time suspended [s]
    double largest_path_deviation = 0.0;  ///< measured tool frame from the planned path [m]
    /// When the first and the last set-point of the motion were given, by the clock of whoever ran
    /// it [s since 1970-01-01 UTC].
    double motion_start_time = 0.0;
    double motion_end_time = 0.0;
    /// Most that a set-point came before or after its time, counted from StartTime if there was
    /// one, else from the first set-point [s]; 0 where the controller plans.
    double largest_lateness = 0.0;
};

/// What a force move tells when it is done; forces in the base frame.
struct ForceMoveResults : MoveResults {
    skill::Vector3 contact_force;    ///< at the end [N]
    skill::Vector3 contact_torque;   ///< at the end [Nm]
    skill::Vector3 forces_exceeded;  ///< that ended the motion [N]; zero if none did
    skill::Vector3 forces_max;       ///< largest along each axis, without sign [N]
};

/// Most poses of one path: more take too long to plan while a server waits.
inline constexpr std::size_t kMostPoses = 100;

/// What MaxVelocity and MaxAcceleration bound.
enum class MoveKind : std::uint8_t {
    ptp,     ///< each axis
    linear,  ///< x, y, z, then rotation about x, y, z, of the tool frame
};

/// What joint positions may be written, of whichever axis [rad]: as the NodeSet has it, wider if
/// the model's own ranges are. A relative target is no wider either.
Range jointRangeOf(const motion::RobotModel& model);

/// The parameters as a server offers them for `model`, with all checks that need no other
/// parameter. `model` must outlive the lists.
///
/// MaxVelocity, MaxAcceleration and AxisBounds may have any length while all zero: published
/// clients always send six values.
skill::FieldList<CartesianMoveParameters> cartesianMoveFields(const motion::RobotModel& model,
                                                              MoveKind kind);
skill::FieldList<PathMoveParameters> pathMoveFields(const motion::RobotModel& model);
skill::FieldList<JointMoveParameters> jointMoveFields(const motion::RobotModel& model,
                                                      MoveKind kind);
const skill::FieldList<MoveResults>& moveResultFields();
skill::FieldList<ForceMoveParameters> forceMoveFields(const motion::RobotModel& model);
const skill::FieldList<ForceMoveResults>& forceMoveResultFields();

}  // namespace metier::robot_skills
