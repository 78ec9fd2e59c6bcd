#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "metier/base/error.hpp"
#include "metier/motion/motion_run.hpp"
#include "metier/motion/pose.hpp"
#include "metier/motion/robot_model.hpp"
#include "metier/motion/trajectory.hpp"

namespace metier::motion {

/// Frame in which a target pose is given.
enum class TargetReference {
    /// Absolute: the target is base_from_tool.
    base,
    /// Relative to the start pose: translation and rotation along the base axes.
    relative_base,
    /// Relative to the start pose: the target is start_tool_from_target.
    relative_tool,
};

/// A motion straight in joint space (PTP).
struct PtpRequest {
    /// Position at which the arm is at rest [rad]; size axisCount(), at most 1e-3 rad outside the
    /// joint limits.
    JointVector start;
    /// Target: a joint position [rad], or a pose of the tool frame.
    std::variant<JointVector, Pose> target;
    /// Frame of a target pose; not used for a joint position.
    TargetReference reference = TargetReference::base;
    /// Name of the tool frame; "" or "flange": the flange.
    std::string tool_frame;
    /// Limit of each axis, > 0 [rad/s]. Empty or 0: the robot's own limit, which is never exceeded.
    JointVector max_velocity;
    /// Limit of each axis, > 0 [rad/s2]. Empty or 0: the robot's own limit, which is never
    /// exceeded.
    JointVector max_acceleration;
    /// Factor of the speed limits, (0, 1]; accelerations stay.
    double speed_override = 1.0;
    /// Range of the joint position at the target, if that is a pose.
    AxisBounds axis_bounds;
    /// Arm angle at the target [rad], for a 7-axis arm and a target pose; none: the nearest one.
    std::optional<double> redundancy_angle;
    /// Pose of the tool frame, base_from_tool, to which a line goes next from a target pose: of the
    /// joint positions at the target the nearest from which that line can be planned is taken.
    std::optional<Pose> next_line;
};

/// Values for x, y, z, then rotation about x, y, z, all in the base frame.
using CartesianVector = std::array<double, 6>;

/// A motion whose tool frame moves along a straight line and turns the short way meanwhile (LIN).
struct LinRequest {
    /// Position at which the arm is at rest [rad]; as in PtpRequest.
    JointVector start;
    /// Target pose of the tool frame, with a unit quaternion.
    Pose target;
    /// Frame of the target.
    TargetReference reference = TargetReference::base;
    /// Name of the tool frame; "" or "flange": the flange.
    std::string tool_frame;
    /// Limits of the tool frame, > 0 [m/s], [rad/s]. 0: the robot's own limit, which is never
    /// exceeded. Three equal values bound the length of the vector, unequal ones each component.
    CartesianVector max_velocity{};
    /// Limits of the tool frame, > 0 [m/s2], [rad/s2], by the same rules.
    CartesianVector max_acceleration{};
    /// Factor of the speed limits, (0, 1]; accelerations stay.
    double speed_override = 1.0;
    /// Range of the axes on the whole path.
    AxisBounds axis_bounds;
    /// Arm angle at the end of the path [rad], for a 7-axis arm; none: chosen along the way.
    std::optional<double> redundancy_angle;
};

/// A LIN to the pose that the tool frame has at a joint position. The arm may reach that pose in
/// another joint position than the given one.
struct JointLinearRequest {
    /// Start, limits and tool frame; `target` and `reference` are not used, nor is
    /// `redundancy_angle` for a 7-axis arm.
    LinRequest lin;
    /// Joint position whose pose is the target [rad]; within the joint limits.
    JointVector target;
};

/// A place on a path of several lines.
struct PathWaypoint {
    /// Pose of the tool frame here, with a unit quaternion.
    Pose target;
    /// Distance by which the corner here may be cut [m]: 1e-6 m or more (less where the tool frame
    /// turns more than it moves), at most half of the shorter line beside it, where a rotation
    /// counts as 0.25 m/rad. Not used for the last waypoint.
    double blend_radius = 0;
    /// Limit on the way to here [m/s]; 0: as the whole path.
    double max_velocity = 0;
    /// Limit of the rotation on the way to here [rad/s]; 0: as the whole path.
    double max_angular_velocity = 0;
};

/// Lines through several poses without a stop; velocity and angular velocity have no jump.
struct PathRequest {
    /// Start, tool frame, limits (the smallest of three values bounds the length of the vector) and
    /// axis bounds. `reference` relates every waypoint to the one before; `target` is not used.
    LinRequest lin;
    std::vector<PathWaypoint> waypoints;  ///< at least one; neighbours must differ
};

/// Reasons why a motion cannot be planned.
enum class RefusalReason {
    /// Sizes, not finite, out of range, unknown tool frame.
    invalid_request,
    /// No joint position reaches the target.
    unreachable,
    /// An axis would leave its limits or bounds, or stands outside of them at the start.
    joint_limit,
    /// The arm would have to flip on the way.
    configuration_change,
    /// The axes could not follow on the way.
    singularity,
    /// Two links would touch; only for a model that has capsules.
    collision,
};
/// The enumerator's name, for logs and results. Valid for ever. Threads: any; pure.
std::string_view toString(RefusalReason reason) noexcept;

/// A refused motion; `error.message` has value, limit and unit.
struct Refusal {
    /// Kind of the refusal.
    RefusalReason reason = RefusalReason::invalid_request;
    /// Code and text of the refusal.
    Error error;
    /// First place on the path where it fails, 0 to 1; 0 if the request itself is wrong.
    double fraction = 0;
    /// Axis that causes the refusal, from 0, if there is one.
    std::optional<std::size_t> axis;
};

/// A plan, or the reason why there is none.
template <typename T>
using Planned = tl::expected<T, Refusal>;

/// Rule for singular places on a Cartesian path.
enum class SingularPlaces {
    /// The path may pass if it does not move in the direction that the arm has lost there, so that
    /// the axes follow smoothly; for example through an aligned wrist.
    passed_where_axes_follow,
    /// No singular place is allowed, not even at the start or the end.
    refused,
};

/// Thresholds from which a Cartesian path counts as singular.
struct PlannerOptions {
    /// Lowest share of the requested speed to which an axis may slow the path down, [0, 1).
    double slowest_share = 0.02;
    /// A place is singular if the Jacobian's smallest singular value, position [m] and rotation
    /// [rad] taken together, is below this; 0: no place is singular.
    double smallest_singular_value = 0.01;
    /// Rule for the places that count as singular.
    SingularPlaces singular_places = SingularPlaces::passed_where_axes_follow;
};

/// Plans motions of one robot before they start: a returned trajectory can be run to its end, by a
/// MotionRun.
///
///     const Planner planner(model);
///     auto plan = planner.ptp({.start = q, .target = base_from_tool, .tool_frame = "tool"});
///     if (!plan) { ... plan.error().error.message ... }
///
/// Threading: any thread; pure; allocates. Not for a cycle thread. The model must outlive
/// the planner; trajectories do not need it.
class Planner {
public:
    /// \param options for paths of the tool frame; a PTP does not use them
    explicit Planner(const RobotModel& model, const PlannerOptions& options = {}) noexcept
        : model_(&model), options_(options) {}

    /// Plans a motion straight in joint space; all axes arrive together. A target equal to the
    /// start gives a motion of no duration. Refused as invalid_request, unreachable, joint_limit or
    /// collision; with a next_line that can be planned from no joint position, as that line is from
    /// the nearest. At most 16 lines are tried.
    Planned<Trajectory> ptp(const PtpRequest& request) const;
    /// Plans a straight line; slows down along the path where an axis limits it. May be refused for
    /// every reason.
    Planned<Trajectory> lin(const LinRequest& request) const;
    /// Plans a straight line to the pose of a joint position; as lin().
    Planned<Trajectory> jointLinear(const JointLinearRequest& request) const;
    /// Plans several lines with cut corners, without a stop; as lin(). The text of a refusal names
    /// the waypoint.
    Planned<Trajectory> path(const PathRequest& request) const;

private:
    Planned<Trajectory> ptpBeforeLine(const PtpRequest& request,
                                      const std::vector<JointVector>& targets,
                                      const Pose& flange_from_tool) const;
    std::optional<Refusal> refusalOf(const LinRequest& request) const;

    const RobotModel* model_;
    PlannerOptions options_;
};

/// Answer to the question whether a motion could start.
struct Feasibility {
    /// Reason against it; none: it can start.
    std::optional<Refusal> refusal;
    /// Duration of the motion [s]; 0 if it cannot start.
    Seconds duration{0};
    /// Longest time and way that halt() would need at any of 200 moments of the motion.
    StoppingEstimate longest_stop{};
    /// Joint positions along the path, both ends included [rad]; empty if it cannot start.
    std::vector<JointVector> preview;
};

/// Describes a plan.
/// \param preview_points number of positions, >= 2, equally spaced in time
/// Threads: any; pure; runs the whole motion once, so it takes as long as a plan.
Feasibility assess(const Planned<Trajectory>& plan, std::size_t preview_points);

}  // namespace metier::motion
