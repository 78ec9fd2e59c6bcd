#include "planned_move.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "joint_text.hpp"
#include "metier/motion/frame.hpp"
#include "metier/robot_skills/move_planning.hpp"
#include "value_text.hpp"

namespace metier::app {
namespace {

using motion::JointVector;
using motion::Planned;
using motion::RobotModel;
using motion::Trajectory;
using robot_skills::CartesianMoveParameters;
using robot_skills::JointMoveParameters;
using robot_skills::MoveKind;
using robot_skills::MoveParameters;
using robot_skills::Relative;

MoveKind kindOf(const MoveOptions& options) {
    return options.linear ? MoveKind::linear : MoveKind::ptp;
}

/// Maxima as the skill takes them. One value counts for all axes of a PTP and for x, y, z of a
/// linear move; two of a linear move for x, y, z and for the rotations.
Result<std::vector<double>> maxima(const MoveOptions& options, const std::string& text,
                                   const RobotModel& model) {
    if (text.empty()) {
        return std::vector<double>();
    }
    auto values = parseNumbers({{text}}, "maximum");
    if (!values || values->size() > 2) {
        return values;
    }
    if (!options.linear) {
        return values->size() == 1 ? std::vector<double>(model.axisCount(), values->front())
                                   : *values;
    }
    const double turning = values->size() == 2 ? values->back() : 0.0;
    std::vector<double> six(6, turning);
    std::fill_n(six.begin(), 3, values->front());
    return six;
}

Result<void> readCommon(const MoveOptions& options, const RobotModel& model,
                        MoveParameters& parameters) {
    METIER_ASSIGN(parameters.max_velocity, maxima(options, options.max_velocity, model));
    METIER_ASSIGN(parameters.max_acceleration, maxima(options, options.max_acceleration, model));
    if (!options.arm_angle.empty()) {
        METIER_ASSIGN(const auto angle, parseNumbers({{options.arm_angle}}, "arm angle"));
        parameters.redundancy_angle = angle.front();
    }
    parameters.tool_frame = options.tool;
    parameters.speed_override = options.speed_override;
    parameters.relative =
        static_cast<std::int32_t>(options.relative == "base"   ? Relative::base
                                  : options.relative == "tool" ? Relative::tool
                                                               : Relative::absolute);
    return {};
}

/// Refusal for parameters that cannot be written.
tl::unexpected<motion::Refusal> notTaken(Error error) {
    motion::Refusal refusal;
    refusal.error = std::move(error);
    return tl::unexpected(std::move(refusal));
}

/// Checks as the writes to the server do, then plans as Start does.
template <typename Parameters, typename Plan>
Planned<Trajectory> checkAndPlan(const skill::FieldList<Parameters>& fields,
                                 const Parameters& parameters, Plan plan) {
    const auto taken = fields.read(fields.write(parameters));
    return taken ? plan(*taken) : Planned<Trajectory>(notTaken(taken.error()));
}

Result<PlannedMove> planToJoints(const RobotModel& model, const JointVector& start,
                                 const MoveOptions& options) {
    JointMoveParameters parameters;
    METIER_ASSIGN(const auto target, parseJoints(model, {{options.to_joints}}, "target"));
    METIER_TRY(readCommon(options, model, parameters));
    parameters.target_joint_position.assign(target.begin(), target.end());
    const auto& plan = options.linear ? robot_skills::planJointLinear : robot_skills::planJointPtp;
    return PlannedMove{
        options.linear ? "JointLinearMoveSkill" : "JointPtpMoveSkill", start,
        checkAndPlan(robot_skills::jointMoveFields(model, kindOf(options)), parameters,
                     [&](const auto& taken) { return plan(model, start, taken); })};
}

Result<CartesianMoveParameters> poseParameters(const RobotModel& model, const MoveOptions& options,
                                               const std::string& pose) {
    CartesianMoveParameters parameters;
    METIER_ASSIGN(const auto target, parsePose({{pose}}, "target"));
    METIER_TRY(readCommon(options, model, parameters));
    const auto frame = motion::toFrame(target);
    parameters.target_position = {frame.x, frame.y, frame.z, frame.a, frame.b, frame.c};
    METIER_ASSIGN(const auto bounds, parseValue(skill::ValueType::ranges, options.axis_bounds));
    parameters.axis_bounds = std::get<std::vector<skill::Range>>(bounds);
    return parameters;
}

Result<PlannedMove> planToPose(const RobotModel& model, const JointVector& start,
                               const MoveOptions& options) {
    METIER_ASSIGN(const auto parameters, poseParameters(model, options, options.to_poses.front()));
    const auto& plan =
        options.linear ? robot_skills::planCartesianLinear : robot_skills::planCartesianPtp;
    return PlannedMove{
        options.linear ? "CartesianLinearMoveSkill" : "CartesianPtpMoveSkill", start,
        checkAndPlan(robot_skills::cartesianMoveFields(model, kindOf(options)), parameters,
                     [&](const auto& taken) { return plan(model, start, taken); })};
}

/// Lines through several poses, corners rounded.
Result<PlannedMove> planAlongPoses(const RobotModel& model, const JointVector& start,
                                   const MoveOptions& options) {
    if (!options.linear) {
        return fail(Errc::invalid_argument, "several targets are for --linear only");
    }
    std::vector<motion::PathWaypoint> waypoints;
    for (const auto& text : options.to_poses) {
        METIER_ASSIGN(const auto pose,
                      parsePose({{text}}, fmt::format("target {}", waypoints.size() + 1)));
        waypoints.push_back({pose, options.blend_radius});
    }
    METIER_ASSIGN(const auto parameters, poseParameters(model, options, options.to_poses.back()));
    return PlannedMove{"CartesianPathMoveSkill", start,
                       checkAndPlan(robot_skills::cartesianMoveFields(model, MoveKind::linear),
                                    parameters, [&](const auto& taken) {
                                        return motion::Planner(model).path(
                                            {robot_skills::linRequest(start, taken), waypoints});
                                    })};
}

}  // namespace

void addMoveOptions(CLI::App& command, MoveOptions& options) {
    command
        .add_option("--from", options.from,
                    "Joint positions where the arm stands [rad]; without it the model's home")
        ->type_name("q1,q2,...");
    auto* poses =
        command
            .add_option("--to-pose", options.to_poses,
                        "Pose of the tool frame to move to, in the base frame [m, rad]; with "
                        "--linear several, with rounded corners")
            ->type_name("x,y,z,a,b,c")
            ->allow_extra_args(false);
    command.add_option("--to-joints", options.to_joints, "Joint positions to move to [rad]")
        ->type_name("q1,q2,...")
        ->excludes(poses);
    command.add_flag("--linear", options.linear, "Along a straight line; without it PTP");
    command
        .add_option("--relative", options.relative,
                    "What the target is added to: no, base (along the base axes, or to the joint "
                    "position), tool (along the axes of the tool frame)")
        ->check(CLI::IsMember({"no", "base", "tool"}))
        ->capture_default_str();
    command.add_option("--tool", options.tool,
                       "The tool frame that is moved; without it the flange");
    command
        .add_option("--max-velocity", options.max_velocity,
                    "PTP: of each axis, or one for all [rad/s]; --linear: v [m/s], or v,w with the "
                    "rotation's [rad/s], or six values; without it, or 0: the robot's own")
        ->type_name("FLOAT,...");
    command
        .add_option("--max-acceleration", options.max_acceleration,
                    "The same, accelerations [rad/s2], [m/s2]")
        ->type_name("FLOAT,...");
    command.add_option("--override", options.speed_override, "Share of the speed, over 0 up to 1")
        ->capture_default_str();
    command
        .add_option("--arm-angle", options.arm_angle,
                    "Of a seven-axis arm's elbow at the target [rad]; without it as at the start")
        ->type_name("FLOAT");
    command.add_option("--axis-bounds", options.axis_bounds, "Bounds of each axis [rad]")
        ->type_name("low:high,...");
    command
        .add_option("--blend", options.blend_radius,
                    "How far before a pose its corner may begin, if there are several [m]")
        ->capture_default_str();
}

bool hasTarget(const MoveOptions& options) noexcept {
    return !options.to_poses.empty() || !options.to_joints.empty();
}

Result<PlannedMove> planMove(const RobotModel& model, const MoveOptions& options) {
    if (!hasTarget(options)) {
        return fail(Errc::invalid_argument, "name a target with --to-pose or --to-joints");
    }
    METIER_ASSIGN(const auto start, options.from.empty()
                                        ? Result<JointVector>(model.home())
                                        : parseJoints(model, {{options.from}}, "start"));
    if (!options.to_joints.empty()) {
        return planToJoints(model, start, options);
    }
    return options.to_poses.size() == 1 ? planToPose(model, start, options)
                                        : planAlongPoses(model, start, options);
}

}  // namespace metier::app
