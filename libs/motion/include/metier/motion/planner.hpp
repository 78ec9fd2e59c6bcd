#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "metier/base/error.hpp"
#include "metier/motion/pose.hpp"
#include "metier/motion/motion_run.hpp"
#include "metier/motion/robot_model.hpp"
#include "metier/motion/trajectory.hpp"

namespace metier::motion {

/// What a target pose is relative to.
enum class TargetReference {
    base,           ///< absolute: base_from_tool
    relative_base,  ///< from the start pose: translation and rotation along the base axes
    relative_tool,  ///< from the start pose: start_tool_from_target
};

/// A motion straight in joint space.
struct PtpRequest {
    JointVector start;  ///< at rest there [rad]
    std::variant<JointVector, motion::Pose>
        target;  ///< joint position, or pose of the tool frame
    TargetReference reference = TargetReference::base;  ///< of a pose
    std::string tool_frame;                             ///< "": the flange
    /// Per axis, > 0 [rad/s], [rad/s2]; empty or a 0: the robot's own, which also caps.
    JointVector max_velocity;
    JointVector max_acceleration;
    double speed_override = 1.0;  ///< (0, 1], multiplies the speed limits
    AxisBounds axis_bounds;       ///< of the target's joint position
    std::optional<double> redundancy_angle;
};

/// x, y, z, then rotation about x, y, z, all in the base frame.
using CartesianVector = std::array<double, 6>;

/// A motion whose tool frame runs along a straight line and turns the short way meanwhile.
struct LinRequest {
    JointVector start;      ///< at rest there [rad]
    motion::Pose target;  ///< of the tool frame
    TargetReference reference = TargetReference::base;
    std::string tool_frame;
    /// > 0 [m/s], [rad/s] and [m/s2], [rad/s2]; a 0: the robot's own, which also caps. Three equal
    /// values bound the length of the vector, unequal ones each component.
    CartesianVector max_velocity{};
    CartesianVector max_acceleration{};
    double speed_override = 1.0;             ///< (0, 1], multiplies the speed limits
    AxisBounds axis_bounds;                  ///< for the whole path
    std::optional<double> redundancy_angle;  ///< at the end of the path
};

/// A LIN to where the tool frame is at a joint position.
struct JointLinearRequest {
    LinRequest lin;  ///< `target` and `reference` are not used
    JointVector target;
};

/// A place on a path of several lines.
struct PathWaypoint {
    motion::Pose target;  ///< of the tool frame
    /// The corner here may be cut by this much, 1e-9 m or more, at most half of the shorter line
    /// beside it, where a turn counts for 0.25 m/rad; not used for the last one.
    double blend_radius = 0;
    double max_velocity = 0;          ///< on the way here [m/s]; 0: as the whole path
    double max_angular_velocity = 0;  ///< [rad/s]; 0: as the whole path
};

/// Lines through several poses without a stop; velocity and angular velocity have no jump.
struct PathRequest {
    /// Start, tool frame, limits (the least of three bounds the length of the vector), bounds; its
    /// `reference` is that of every waypoint to the one before; `target` is not used.
    LinRequest lin;
    std::vector<PathWaypoint> waypoints;  ///< at least one, no two in a row the same
};

/// Why a motion cannot be planned.
enum class RefusalReason {
    invalid_request,       ///< sizes, not finite, out of range, unknown tool frame
    unreachable,           ///< no joint position reaches the target
    joint_limit,           ///< an axis would leave its limits or bounds on the way
    configuration_change,  ///< the arm would have to flip on the way
    singularity,           ///< the axes could not follow on the way
    collision,             ///< two links would touch
};
std::string_view toString(RefusalReason reason) noexcept;

/// A refused motion: `error.message` tells value, limit and unit.
struct Refusal {
    RefusalReason reason = RefusalReason::invalid_request;
    Error error;
    double fraction = 0;              ///< of the path, where it fails first, 0 to 1
    std::optional<std::size_t> axis;  ///< which axis, from 0, where one is to blame
};

template <typename T>
using Planned = tl::expected<T, Refusal>;

/// What a Cartesian path may do in a singular place.
enum class SingularPlaces {
    /// It may pass where its direction is not the one the arm has lost, so that the axes follow
    /// smoothly: through an aligned wrist, for example.
    passed_where_axes_follow,
    refused,  ///< no such place at all, not even to start from or to end in
};

/// When a Cartesian path counts as singular.
struct PlannerOptions {
    /// An axis may slow the path down to this share of the requested speed, [0, 1).
    double slowest_share = 0.02;
    /// A place is singular where the Jacobian's smallest singular value, position [m] and rotation
    /// [rad] taken together, is less; 0: no place is.
    double smallest_singular_value = 0.01;
    SingularPlaces singular_places = SingularPlaces::passed_where_axes_follow;
};

/// Plans motions of one robot before they start: what it returns can be run to the end.
///
/// Threading: any thread; pure; allocates. Not for a cycle thread.
/// The model must outlive the planner, not its trajectories.
class Planner {
public:
    explicit Planner(const RobotModel& model, const PlannerOptions& options = {}) noexcept
        : model_(&model), options_(options) {}

    Planned<Trajectory> ptp(const PtpRequest& request) const;
    /// Slows down along the path where an axis limits it.
    Planned<Trajectory> lin(const LinRequest& request) const;
    Planned<Trajectory> jointLinear(const JointLinearRequest& request) const;
    Planned<Trajectory> path(const PathRequest& request) const;

private:
    const RobotModel* model_;
    PlannerOptions options_;
};

/// The planners with an Error only.
Result<Trajectory> planPtp(const RobotModel& model, const PtpRequest& request);
Result<Trajectory> planLin(const RobotModel& model, const LinRequest& request);
Result<Trajectory> planJointLinear(const RobotModel& model, const JointLinearRequest& request);
Result<Trajectory> planPath(const RobotModel& model, const PathRequest& request);

/// The same motions on one clock: the quicker ones are stretched to the slowest one's duration.
void synchronise(std::vector<Trajectory>& trajectories);

/// The answer to "could this start?".
struct Feasibility {
    std::optional<Refusal> refusal;    ///< none: it can start
    Seconds duration{0};               ///< of the motion, if it can start
    StoppingEstimate longest_stop{};        ///< most that halt() would need of each, at any time of it
    std::vector<JointVector> preview;  ///< joint positions along the path, ends included
};

/// What the plan says, with `preview_points` (>= 2) positions equally spaced in time.
Feasibility assess(const Planned<Trajectory>& plan, std::size_t preview_points);

}  // namespace metier::motion
