#include "metier/robot_skills/move_skills.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <utility>

#include "arm_body.hpp"
#include "arm_skill.hpp"
#include "conversions.hpp"
#include "metier/geometry/frame.hpp"
#include "metier/motion/planner.hpp"
#include "metier/robot_skills/move_parameters.hpp"
#include "metier/skill/typed_skill.hpp"
#include "move_source.hpp"

namespace metier::robot_skills {

using motion::JointVector;
using motion::RobotModel;
using motion::Trajectory;
using Path = PathDeviationMeter::Path;

namespace {

template <typename Parameters>
using Plan =
    std::function<Result<Trajectory>(const RobotModel&, const JointVector&, const Parameters&)>;

/// What makes one move different from the others.
template <typename Parameters>
struct Kind {
    skill::SkillDescription description;
    skill::FieldList<Parameters> fields;
    Path path;
    Plan<Parameters> plan;
};

ArmBody::ToolDistance toolDistance(const Trajectory& trajectory) {
    return [trajectory](const device::JointArray& a, const device::JointArray& b) {
        return geometry::distanceBetween(trajectory.toolPose(toVector(a)),
                                         trajectory.toolPose(toVector(b)));
    };
}

template <typename Parameters>
class MoveSkill final : public skill::TypedSkill<Parameters, MoveResults> {
public:
    MoveSkill(device::Arm& arm, const RobotModel& model, Kind<Parameters> kind)
        : skill::TypedSkill<Parameters, MoveResults>(std::move(kind.description),
                                                     std::move(kind.fields), moveResultFields()),
          arm_(arm),
          model_(model),
          path_(kind.path),
          plan_(std::move(kind.plan)) {}

    Result<void> reset() override { return arm_.resetFault(); }

protected:
    Result<std::unique_ptr<skill::Body>> plan(const Parameters& parameters) override {
        if (auto ready = checkReady(arm_); !ready) {
            return fail(std::move(ready.error()));
        }
        const auto start = toVector(arm_.state().commanded_position);
        auto trajectory = plan_(model_, start, parameters);
        if (!trajectory) {
            return fail(std::move(trajectory.error()));
        }
        auto source = std::make_shared<MoveSource>(arm_.info(), *trajectory, path_);
        return std::make_unique<ArmBody>(arm_, std::move(source), toolDistance(*trajectory));
    }

private:
    device::Arm& arm_;
    const RobotModel& model_;
    Path path_;
    Plan<Parameters> plan_;
};

bool allZero(const std::vector<double>& values) {
    return std::all_of(values.begin(), values.end(), [](double v) { return v == 0.0; });
}

/// Per-axis maxima for the planner: empty for "not set", whatever its length.
JointVector axisMaxima(const std::vector<double>& values) {
    return allZero(values) ? JointVector() : JointVector::from(values).value_or(JointVector());
}

motion::CartesianVector cartesianMaxima(const std::vector<double>& values) {
    motion::CartesianVector maxima{};
    if (!allZero(values)) {
        std::copy_n(values.begin(), std::min(values.size(), maxima.size()), maxima.begin());
    }
    return maxima;
}

motion::AxisBounds axisBounds(const std::vector<skill::Range>& ranges) {
    const bool not_set = std::all_of(ranges.begin(), ranges.end(), [](const skill::Range& range) {
        return range == skill::Range{};
    });
    if (not_set) {
        return {};
    }
    motion::AxisBounds bounds{JointVector(ranges.size()), JointVector(ranges.size())};
    for (std::size_t axis = 0; axis < ranges.size(); ++axis) {
        bounds.lower[axis] = ranges[axis].low;
        bounds.upper[axis] = ranges[axis].high;
    }
    return bounds;
}

motion::TargetReference reference(const MoveParameters& parameters) {
    switch (static_cast<Relative>(parameters.relative)) {
        case Relative::absolute:
            return motion::TargetReference::base;
        case Relative::base:
            return motion::TargetReference::relative_base;
        case Relative::tool:
            return motion::TargetReference::relative_tool;
    }
    return motion::TargetReference::base;
}

JointVector jointTarget(const JointVector& start, const JointMoveParameters& parameters) {
    auto target = JointVector::from(parameters.target_joint_position).value_or(start);
    if (static_cast<Relative>(parameters.relative) == Relative::base) {
        target.view() += start.view();
    }
    return target;
}

motion::PtpRequest ptpRequest(const JointVector& start, const MoveParameters& parameters) {
    motion::PtpRequest request;
    request.start = start;
    request.tool_frame = parameters.tool_frame;
    request.max_velocity = axisMaxima(parameters.max_velocity);
    request.max_acceleration = axisMaxima(parameters.max_acceleration);
    request.speed_override = parameters.speed_override;
    request.redundancy_angle = parameters.redundancy_angle;
    return request;
}

motion::LinRequest linRequest(const JointVector& start, const MoveParameters& parameters) {
    motion::LinRequest request;
    request.start = start;
    request.tool_frame = parameters.tool_frame;
    request.max_velocity = cartesianMaxima(parameters.max_velocity);
    request.max_acceleration = cartesianMaxima(parameters.max_acceleration);
    request.speed_override = parameters.speed_override;
    request.redundancy_angle = parameters.redundancy_angle;
    return request;
}

Result<Trajectory> planCartesianPtp(const RobotModel& model, const JointVector& start,
                                    const CartesianMoveParameters& parameters) {
    auto request = ptpRequest(start, parameters);
    request.target = geometry::toPose(parameters.target_position);
    request.reference = reference(parameters);
    request.axis_bounds = axisBounds(parameters.axis_bounds);
    return motion::planPtp(model, request);
}

Result<Trajectory> planCartesianLinear(const RobotModel& model, const JointVector& start,
                                       const CartesianMoveParameters& parameters) {
    auto request = linRequest(start, parameters);
    request.target = geometry::toPose(parameters.target_position);
    request.reference = reference(parameters);
    request.axis_bounds = axisBounds(parameters.axis_bounds);
    return motion::planLin(model, request);
}

Result<Trajectory> planJointPtp(const RobotModel& model, const JointVector& start,
                                const JointMoveParameters& parameters) {
    auto request = ptpRequest(start, parameters);
    request.target = jointTarget(start, parameters);
    return motion::planPtp(model, request);
}

Result<Trajectory> planJointLinear(const RobotModel& model, const JointVector& start,
                                   const JointMoveParameters& parameters) {
    return motion::planJointLinear(model,
                                   {linRequest(start, parameters), jointTarget(start, parameters)});
}

skill::SkillDescription describe(std::string name, std::string description) {
    return {.name = name, .type = name + "Type", .description = std::move(description)};
}

template <typename Parameters>
Result<std::unique_ptr<skill::Skill>> make(device::Arm& arm, const RobotModel& model,
                                           Kind<Parameters> kind) {
    if (auto checked = checkSameAxes(arm, model); !checked) {
        return fail(std::move(checked.error()));
    }
    return std::make_unique<MoveSkill<Parameters>>(arm, model, std::move(kind));
}

}  // namespace

Result<std::unique_ptr<skill::Skill>> makeCartesianPtpMoveSkill(device::Arm& arm,
                                                                const RobotModel& model) {
    return make<CartesianMoveParameters>(
        arm, model,
        {describe("CartesianPtpMoveSkill",
                  "Moves all axes together so that the tool frame reaches a pose"),
         cartesianMoveFields(model, MoveKind::ptp), Path::joint_line, planCartesianPtp});
}

Result<std::unique_ptr<skill::Skill>> makeCartesianLinearMoveSkill(device::Arm& arm,
                                                                   const RobotModel& model) {
    return make<CartesianMoveParameters>(
        arm, model,
        {describe("CartesianLinearMoveSkill", "Moves the tool frame on a straight line to a pose"),
         cartesianMoveFields(model, MoveKind::linear), Path::cartesian_line, planCartesianLinear});
}

Result<std::unique_ptr<skill::Skill>> makeJointPtpMoveSkill(device::Arm& arm,
                                                            const RobotModel& model) {
    return make<JointMoveParameters>(
        arm, model,
        {describe("JointPtpMoveSkill", "Moves all axes together to a joint position"),
         jointMoveFields(model, MoveKind::ptp), Path::joint_line, planJointPtp});
}

Result<std::unique_ptr<skill::Skill>> makeJointLinearMoveSkill(device::Arm& arm,
                                                               const RobotModel& model) {
    return make<JointMoveParameters>(
        arm, model,
        {describe("JointLinearMoveSkill",
                  "Moves the tool frame on a straight line to where a joint position puts it"),
         jointMoveFields(model, MoveKind::linear), Path::cartesian_line, planJointLinear});
}

}  // namespace metier::robot_skills
