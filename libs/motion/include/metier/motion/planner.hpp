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
    base,           ///< absolute: base_from_tool
    relative_base,  ///< from the start pose: translation and rotation along the base axes
    relative_tool,  ///< from the start pose: start_tool_from_target
};

/// A motion straight in joint space.
struct PtpRequest {
    JointVector start;                       ///< position at which the arm is at rest [rad]
    std::variant<JointVector, Pose> target;  ///< joint position, or pose of the tool frame
    TargetReference reference = TargetReference::base;  ///< frame of a target pose; not used for a
                                                        ///< joint position
    std::string tool_frame;                             ///< name of the tool frame; "": the flange
    /// Limits of each axis, > 0 [rad/s], [rad/s2]. Empty or 0: the robot's own limit, which is
    /// never exceeded.
    JointVector max_velocity;
    JointVector max_acceleration;
    double speed_override = 1.0;  ///< (0, 1], multiplies the speed limits
    AxisBounds axis_bounds;       ///< range of the joint position at the target
    std::optional<double> redundancy_angle;
};

/// x, y, z, then rotation about x, y, z, all in the base frame.
using CartesianVector = std::array<double, 6>;

/// A motion whose tool frame moves along a straight line and turns the short way meanwhile.
struct LinRequest {
    JointVector start;  ///< position at which the arm is at rest [rad]
    Pose target;        ///< pose of the tool frame
    TargetReference reference = TargetReference::base;
    std::string tool_frame;
    /// Limits of the tool frame, > 0 [m/s], [rad/s] and [m/s2], [rad/s2]. 0: the robot's own limit,
    /// which is never exceeded. Three equal values bound the length of the vector, unequal ones
    /// each component.
    CartesianVector max_velocity{};
    CartesianVector max_acceleration{};
    double speed_override = 1.0;             ///< (0, 1], multiplies the speed limits
    AxisBounds axis_bounds;                  ///< range of the axes on the whole path
    std::optional<double> redundancy_angle;  ///< arm angle at the end of the path [rad]
};

/// A LIN to the pose that the tool frame has at a joint position.
struct JointLinearRequest {
    LinRequest lin;  ///< `target` and `reference` are not used
    JointVector target;
};

/// A place on a path of several lines.
struct PathWaypoint {
    Pose target;  ///< pose of the tool frame
    /// Distance by which the corner here may be cut [m]: 1e-9 m or more, at most half of the
    /// shorter line beside it, where a rotation counts as 0.25 m/rad. Not used for the last
    /// waypoint.
    double blend_radius = 0;
    double max_velocity = 0;          ///< on the way to here [m/s]; 0: as the whole path
    double max_angular_velocity = 0;  ///< [rad/s]; 0: as the whole path
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
    invalid_request,       ///< sizes, not finite, out of range, unknown tool frame
    unreachable,           ///< no joint position reaches the target
    joint_limit,           ///< an axis would leave its limits or bounds on the way
    configuration_change,  ///< the arm would have to flip on the way
    singularity,           ///< the axes could not follow on the way
    collision,             ///< two links would touch
};
/// The enumerator's name, for logs and results.
std::string_view toString(RefusalReason reason) noexcept;

/// A refused motion; `error.message` has value, limit and unit.
struct Refusal {
    RefusalReason reason = RefusalReason::invalid_request;
    Error error;
    double fraction = 0;              ///< first place on the path where it fails, 0 to 1
    std::optional<std::size_t> axis;  ///< axis that causes the refusal, from 0, if there is one
};

template <typename T>
using Planned = tl::expected<T, Refusal>;

/// Rule for singular places on a Cartesian path.
enum class SingularPlaces {
    /// The path may pass if it does not move in the direction that the arm has lost there, so that
    /// the axes follow smoothly; for example through an aligned wrist.
    passed_where_axes_follow,
    refused,  ///< no singular place is allowed, not even at the start or the end
};

/// Thresholds from which a Cartesian path counts as singular.
struct PlannerOptions {
    /// Lowest share of the requested speed to which an axis may slow the path down, [0, 1).
    double slowest_share = 0.02;
    /// A place is singular if the Jacobian's smallest singular value, position [m] and rotation
    /// [rad] taken together, is below this; 0: no place is singular.
    double smallest_singular_value = 0.01;
    SingularPlaces singular_places = SingularPlaces::passed_where_axes_follow;
};

/// Plans motions of one robot before they start: a returned trajectory can be run to its end.
///
/// Threading: any thread; pure; allocates. Not for a cycle thread. The model must outlive the
/// planner; trajectories do not need it.
class Planner {
public:
    explicit Planner(const RobotModel& model, const PlannerOptions& options = {}) noexcept
        : model_(&model), options_(options) {}

    /// Plans a motion straight in joint space; all axes arrive together.
    Planned<Trajectory> ptp(const PtpRequest& request) const;
    /// Plans a straight line; slows down along the path where an axis limits it.
    Planned<Trajectory> lin(const LinRequest& request) const;
    /// Plans a straight line that ends at a joint position.
    Planned<Trajectory> jointLinear(const JointLinearRequest& request) const;
    /// Plans several lines with cut corners, without a stop.
    Planned<Trajectory> path(const PathRequest& request) const;

private:
    const RobotModel* model_;
    PlannerOptions options_;
};

/// Answer to the question whether a motion could start.
struct Feasibility {
    std::optional<Refusal> refusal;    ///< reason against it; none: it can start
    Seconds duration{0};               ///< duration of the motion, if it can start
    StoppingEstimate longest_stop{};   ///< longest time and way that halt() would need at any
                                       ///< moment
    std::vector<JointVector> preview;  ///< joint positions along the path, both ends included [rad]
};

/// Describes a plan, with `preview_points` (>= 2) positions equally spaced in time.
Feasibility assess(const Planned<Trajectory>& plan, std::size_t preview_points);

}  // namespace metier::motion
