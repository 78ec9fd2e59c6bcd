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
    absolute = 0,  ///< a pose in the base frame, or a joint position
    base = 1,      ///< added to the start along the base axes, or to its joint position
    tool = 2,      ///< added to the start along the axes of the tool frame; poses only
};

/// Parameters that every move has.
struct MoveParameters {
    std::string tool_frame{};                  ///< "": the flange
    std::vector<double> max_velocity{};        ///< all zero: the robot's own
    std::vector<double> max_acceleration{};    ///< all zero: the robot's own
    std::int32_t relative = 0;                 ///< a Relative
    double blend_radius = 0.0;                 ///< [m]
    double speed_override = 1.0;               ///< fraction of the velocity limits, (0, 1]
    std::optional<double> redundancy_angle{};  ///< [rad]
    std::optional<double> duration{};  ///< duration of the motion [s]; none: as short as possible
    /// Begin of the motion, by the clock of the server that runs it [s since 1970-01-01 UTC]; none:
    /// at once.
    std::optional<double> start_time{};
    /// Time that a Suspend takes [s]. All arms of a common motion brake along their planned times
    /// in it. None: as short as the arm's own limits allow.
    std::optional<double> stop_time{};
};

/// A move to a pose.
struct CartesianMoveParameters : MoveParameters {
    skill::Frame target_position;             ///< pose of the tool frame
    std::vector<skill::Range> axis_bounds{};  ///< [rad]; all zero: the robot's own
};

/// A move to a pose, which a contact force ends early.
struct ForceMoveParameters : CartesianMoveParameters {
    skill::Vector3 max_force;    ///< bounds along x, y, z of the base frame [N]; 0: no limit
    bool halt_on_force = false;  ///< a force over its limit is an error: Halted, not Ready
};

/// A move along straight lines through several poses, with rounded corners.
struct PathMoveParameters : MoveParameters {
    std::vector<skill::Frame> poses{};  ///< poses of the tool frame, at least one
    /// Greatest distance from its pose at which each corner may be cut, > 0 [m]; one per pose, the
    /// last one is not used.
    std::vector<double> blend_radii{};
    std::vector<double> speeds{};  ///< largest speed on the way to each pose [m/s]; 0, or an empty
                                   ///< list: no bound of its own
};

/// A move to a joint position.
struct JointMoveParameters : MoveParameters {
    std::vector<double> target_joint_position{};  ///< [rad]
};

/// Results of a move.
struct MoveResults {
    skill::Frame reached_pose;                     ///< base_from_tool, measured
    std::vector<double> reached_joint_position{};  ///< measured [rad]
    double duration = 0.0;                         ///< time in motion, without suspension [s]
    /// Distance of the measured tool frame from the planned path [m] Times of the first and the
    /// last set-point of the motion, by the clock of the server that ran it [s since 1970-01-01
    /// UTC].
    double largest_path_deviation = 0.0;
    double motion_start_time = 0.0;
    double motion_end_time = 0.0;
    /// Largest time by which a set-point came too early or too late [s], counted from StartTime if
    /// there was one, else from the first set-point; 0 where the controller plans.
    double largest_lateness = 0.0;
};

/// Results of a force move; forces in the base frame.
struct ForceMoveResults : MoveResults {
    skill::Vector3 contact_force;    ///< at the end [N]
    skill::Vector3 contact_torque;   ///< at the end [Nm]
    skill::Vector3 forces_exceeded;  ///< force that ended the motion [N]; zero if none did
    skill::Vector3 forces_max;       ///< largest magnitude along each axis [N]
};

/// Largest number of poses of one path: planning more takes too long, as a server waits for it.
inline constexpr std::size_t kMostPoses = 100;

/// Meaning of the elements of MaxVelocity and MaxAcceleration.
enum class MoveKind : std::uint8_t {
    ptp,     ///< each axis
    linear,  ///< x, y, z, then rotation about x, y, z, of the tool frame
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
skill::FieldList<PathMoveParameters> pathMoveFields(const motion::RobotModel& model);
skill::FieldList<JointMoveParameters> jointMoveFields(const motion::RobotModel& model,
                                                      MoveKind kind);
const skill::FieldList<MoveResults>& moveResultFields();
skill::FieldList<ForceMoveParameters> forceMoveFields(const motion::RobotModel& model);
const skill::FieldList<ForceMoveResults>& forceMoveResultFields();

}  // namespace metier::robot_skills
