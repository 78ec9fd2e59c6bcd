#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "metier/motion/robot_model.hpp"
#include "metier/skill/field_list.hpp"

namespace metier::robot_skills {

/// Reference of a target: RelativeMode of the NodeSet.
enum class Relative : std::int32_t {
    /// The target is a pose in the base frame, or a joint position.
    absolute = 0,
    /// The target is added to the start along the base axes, or to its joint position.
    base = 1,
    /// The target is added to the start along the axes of the tool frame; poses only.
    tool = 2,
};

/// Parameters that every move has.
struct MoveParameters {
    /// Name of a tool frame of the model; "": the flange.
    std::string tool_frame{};
    /// Largest velocities, as MoveKind says [rad/s], or [m/s] and [rad/s]; all zero: the robot's
    /// own.
    std::vector<double> max_velocity{};
    /// Largest accelerations, as MoveKind says [rad/s²], or [m/s²] and [rad/s²]; all zero: the
    /// robot's own.
    std::vector<double> max_acceleration{};
    /// A Relative, as its number.
    std::int32_t relative = 0;
    /// Radius of the blend into a next move [m]; only 0 is taken, all else is not_supported.
    double blend_radius = 0.0;
    /// Factor of the velocity limits, (0, 1].
    double speed_override = 1.0;
    /// Arm angle of a 7-axis arm at the target [rad], -pi to pi; none: as at the start. Other arms
    /// ignore it.
    std::optional<double> redundancy_angle{};
    /// Duration of the motion [s], over 0, up to 3600; none: as short as possible.
    std::optional<double> duration{};
    /// Begin of the motion, by the clock of the server that runs it [s since 1970-01-01 UTC]; none:
    /// at once.
    std::optional<double> start_time{};
    /// Time that a Suspend takes [s], 0 to 3. All arms of a common motion brake along their planned
    /// times in it. None: as short as the arm's own limits allow.
    std::optional<double> stop_time{};
};

/// A move to a pose.
struct CartesianMoveParameters : MoveParameters {
    /// Pose of the tool frame [m, rad], base_from_tool unless it is relative.
    skill::Frame target_position;
    /// Range of each axis [rad]; all zero: the robot's own.
    std::vector<skill::Range> axis_bounds{};
    /// Pose to which a line goes next, base_from_tool [m, rad]: the arm arrives in a joint position
    /// from which it is possible; none: in the nearest. Only a PTP has it.
    std::optional<skill::Frame> next_position{};
};

/// A move to a pose, which a contact force ends early.
struct ForceMoveParameters : CartesianMoveParameters {
    /// Bounds of the force along x, y, z of the base frame [N], 0 to 1000; 0: no limit, and at
    /// least one must be over 0.
    skill::Vector3 max_force;
    /// Whether a force over its limit is an error: Halted instead of Ready.
    bool halt_on_force = false;
};

/// A move along straight lines through several poses, with rounded corners.
struct PathMoveParameters : MoveParameters {
    /// Poses of the tool frame [m, rad], base_from_tool unless they are relative; 1 to kMostPoses.
    std::vector<skill::Frame> poses{};
    /// Greatest distance from its pose at which each corner may be cut, > 0 [m]; one per pose, the
    /// last one is not used.
    std::vector<double> blend_radii{};
    /// Largest speed on the way to each pose [m/s], up to 10; 0, or an empty list: no bound of its
    /// own.
    std::vector<double> speeds{};
};

/// A move to a joint position.
struct JointMoveParameters : MoveParameters {
    /// Joint position [rad], one value per axis, axis 1 first.
    std::vector<double> target_joint_position{};
};

/// Results of a move.
struct MoveResults {
    /// Measured pose at the end, base_from_tool [m, rad].
    skill::Frame reached_pose;
    /// Measured joint position at the end [rad].
    std::vector<double> reached_joint_position{};
    /// Time in motion, without suspension [s].
    double duration = 0.0;
    /// Largest distance of the measured tool frame from the planned path [m].
    double largest_path_deviation = 0.0;
    /// Time of the first set-point, by the clock of the server that ran it [s since 1970-01-01
    /// UTC].
    double motion_start_time = 0.0;
    /// Time of the last set-point, by the same clock.
    double motion_end_time = 0.0;
    /// Largest time by which a set-point came too early or too late [s], counted from StartTime if
    /// there was one, else from the first set-point; 0 where the controller plans.
    double largest_lateness = 0.0;
};

/// Results of a force move; forces in the base frame.
struct ForceMoveResults : MoveResults {
    /// Force at the end [N].
    skill::Vector3 contact_force;
    /// Torque at the end [N m].
    skill::Vector3 contact_torque;
    /// Force that ended the motion [N]; zero if none did.
    skill::Vector3 forces_exceeded;
    /// Largest magnitude along each axis during the motion [N].
    skill::Vector3 forces_max;
};

/// Largest number of poses of one path: planning more takes too long, as a server waits for it.
inline constexpr std::size_t kMostPoses = 100;

/// Meaning of the elements of MaxVelocity and MaxAcceleration.
enum class MoveKind : std::uint8_t {
    /// One value for each axis.
    ptp,
    /// Six values for the tool frame: x, y, z, then rotation about x, y, z.
    linear,
};

/// Range [rad] of the joint positions that may be written, one for all axes: that of the NodeSet,
/// wider if the model's own ranges are wider. It bounds relative targets, too.
Range jointRangeOf(const motion::RobotModel& model);

/// Fields of the parameters as a server publishes them for `model`, with all checks that need no
/// other parameter. `model` must outlive the lists.
///
/// MaxVelocity, MaxAcceleration and AxisBounds may have any length while all elements are zero:
/// published clients always send six values.
skill::FieldList<CartesianMoveParameters> cartesianMoveFields(const motion::RobotModel& model,
                                                              MoveKind kind);
/// Fields of a path; the number of radii and speeds is checked at Start.
skill::FieldList<PathMoveParameters> pathMoveFields(const motion::RobotModel& model);
/// Fields of a move to a joint position.
skill::FieldList<JointMoveParameters> jointMoveFields(const motion::RobotModel& model,
                                                      MoveKind kind);
/// Fields of the results of a move; lives as long as the program. Any thread.
const skill::FieldList<MoveResults>& moveResultFields();
/// Fields of a force move, which is a line.
skill::FieldList<ForceMoveParameters> forceMoveFields(const motion::RobotModel& model);
/// Fields of the results of a force move; lives as long as the program. Any thread.
const skill::FieldList<ForceMoveResults>& forceMoveResultFields();

}  // namespace metier::robot_skills
