#include "metier/robot_skills/move_parameters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>
#include <string_view>
#include <utility>

#include "field_member.hpp"

namespace metier::robot_skills {

using skill::Field;
using skill::Place;
using skill::Range;
using skill::Value;

namespace {

constexpr std::size_t kCartesianDimensions = 6;
constexpr double kLongestRadius = 10.0;  // [m]
constexpr double kHighestSpeed = 10.0;   // [m/s]

/// Accepts all zero of any length, else exactly `count` values.
/// \param error with places for the present and the right number of values
template <typename Element>
Result<void> checkCount(const Value& value, std::size_t count, std::string_view error) {
    const auto& values = std::get<std::vector<Element>>(value);
    const bool not_set = std::all_of(values.begin(), values.end(),
                                     [](const Element& element) { return element == Element{}; });
    return not_set || values.size() == count
               ? Result<void>()
               : fail(Errc::out_of_range, fmt::format(fmt::runtime(error), values.size(), count));
}

// Range of joint positions in the NodeSet [rad].
constexpr Range kUsualJointRange{-6.5, 6.5};

struct Maximum {
    std::string name;
    std::size_t count;
    double highest;
    skill::Unit unit;
};

Field maximumField(const Maximum& maximum, std::string description) {
    const auto& [name, count, highest, unit] = maximum;
    return {.name = name,
            .description = std::move(description),
            .unit = unit,
            .range = Range{0.0, highest},
            .default_value = std::vector<double>(count, 0.0),
            .extra_check = [count = count](const Value& value) {
                return checkCount<double>(value, count, "{} values, expected {} or all zero");
            }};
}

Field toolFrameField(const motion::RobotModel& model) {
    return {.name = "ToolFrame",
            .description = "Name of the tool frame that is moved; empty: the flange",
            .default_value = std::string(),
            .extra_check = [&model](const Value& value) -> Result<void> {
                METIER_TRY(model.tool(std::get<std::string>(value)));
                return {};
            }};
}

Field relativeField(Relative last) {
    return {.name = "Relative",
            .description =
                "What the target is relative to: 0 absolute, 1 along the base axes "
                "or to the joint position, 2 along the axes of the tool frame",
            .range = Range{0.0, static_cast<double>(last)},
            .default_value = std::int32_t{0},
            .place = Place::options};
}

Field nextPositionField() {
    return {.name = "NextPosition",
            .description =
                "Pose in the base frame to which the tool frame goes next on a line: the arm "
                "arrives in a joint position from which that is possible",
            .unit = skill::kMetre,
            .place = Place::options};
}

Field blendRadiusField() {
    return {.name = "BlendRadius",
            .description = "Radius of the blend into the next move; only 0 so far",
            .unit = skill::kMetre,
            .default_value = 0.0,
            .place = Place::options,
            .extra_check = [](const Value& value) -> Result<void> {
                if (const double radius = std::get<double>(value); radius != 0.0) {
                    return fail(Errc::not_supported,
                                fmt::format("{} m; a single move takes 0 m only", radius));
                }
                return {};
            }};
}

/// A check that a number is over 0.
std::function<Result<void>(const Value&)> overZero(std::string error) {
    return [error = std::move(error)](const Value& value) {
        return std::get<double>(value) > 0.0 ? Result<void>() : fail(Errc::out_of_range, error);
    };
}

Field speedOverrideField() {
    return {.name = "SpeedOverride",
            .description = "Share of the planned speed, over 0 up to 1",
            .range = Range{0.0, 1.0},
            .default_value = 1.0,
            .place = Place::options,
            .extra_check = overZero("0 would never arrive; over 0 up to 1")};
}

Field redundancyField() {
    return {.name = "RedundancyAngle",
            .description =
                "Angle of the elbow of a seven-axis arm at the target; "
                "not set: as at the start; other arms ignore it",
            .unit = skill::kRadian,
            .range = Range{-std::numbers::pi, std::numbers::pi},
            .place = Place::options};
}

// Longer motions are rather a mistake of the unit.
constexpr double kLongestDuration = 3600.0;
// Well below the time after which an execution that does not come to rest is stopped.
constexpr double kLongestStop = 3.0;
constexpr double kLatestTime = 1e11;  // beyond any clock, and so no range for a person

Field durationField() {
    return {.name = "Duration",
            .description = "How long the motion takes; not set: as short as the limits allow",
            .unit = skill::kSecond,
            .range = Range{0.0, kLongestDuration},
            .place = Place::options,
            .extra_check = overZero("0 s is no duration; leave it unset for the shortest")};
}

Field startTimeField() {
    return {.name = "StartTime",
            .description =
                "When the motion begins, by the server's own clock, since "
                "1970-01-01 UTC; not set: at once",
            .unit = skill::kSecond,
            .range = Range{0.0, kLatestTime},
            .place = Place::options};
}

Field stopTimeField() {
    return {.name = "StopTime",
            .description =
                "How long a Suspend brakes, at least, so that arms that move together stop "
                "together; not set: as short as this arm can",
            .unit = skill::kSecond,
            .range = Range{0.0, kLongestStop},
            .place = Place::options};
}

Field maxForceField() {
    return {.name = "MaxForce",
            .description =
                "Force along each axis of the base frame that ends the motion; 0: "
                "no limit along this axis",
            .unit = skill::kNewton,
            .range = Range{0.0, 1000.0},
            .extra_check = [](const Value& value) -> Result<void> {
                if (std::get<skill::Vector3>(value) == skill::Vector3{}) {
                    return fail(Errc::out_of_range, "no axis has a limit over 0 N");
                }
                return {};
            }};
}

Field haltOnForceField() {
    return {.name = "HaltOnForce",
            .description =
                "Whether a force over its limit is an error: Halted, instead of "
                "finished with what was met",
            .default_value = false,
            .place = Place::options};
}

template <typename Parameters>
void addMoveFields(skill::FieldList<Parameters>& fields, const motion::RobotModel& model,
                   MoveKind kind) {
    const bool ptp = kind == MoveKind::ptp;
    const auto count = ptp ? model.axisCount() : kCartesianDimensions;
    const std::string of = ptp ? "of each axis" : "x, y, z, then about x, y, z";
    add(fields, &MoveParameters::tool_frame, toolFrameField(model));
    add(fields, &MoveParameters::max_velocity,
        maximumField(ptp ? Maximum{"MaxVelocity", count, 20.0, skill::kRadianPerSecond}
                         : Maximum{"MaxVelocity", count, 10.0, skill::kMetrePerSecond},
                     "Largest velocity, " + of + "; 0: the robot's own"));
    add(fields, &MoveParameters::max_acceleration,
        maximumField(ptp ? Maximum{"MaxAcceleration", count, 100.0, skill::kRadianPerSecondSquared}
                         : Maximum{"MaxAcceleration", count, 50.0, skill::kMetrePerSecondSquared},
                     "Largest acceleration, " + of + "; 0: the robot's own"));
    add(fields, &MoveParameters::blend_radius, blendRadiusField());
    add(fields, &MoveParameters::speed_override, speedOverrideField());
    add(fields, &MoveParameters::redundancy_angle, redundancyField());
    add(fields, &MoveParameters::duration, durationField());
    add(fields, &MoveParameters::start_time, startTimeField());
    add(fields, &MoveParameters::stop_time, stopTimeField());
}

template <typename Parameters>
void addCartesianFields(skill::FieldList<Parameters>& fields, const motion::RobotModel& model,
                        MoveKind kind) {
    add(fields, &CartesianMoveParameters::target_position,
        Field{
            .name = "TargetPosition",
            .description = "Pose of the tool frame to move to, in the base frame",
            .unit = skill::kMetre,
        });
    const auto axes = model.axisCount();
    add(fields, &CartesianMoveParameters::axis_bounds,
        Field{.name = "AxisBounds",
              .description = "Bounds of each axis; all zero: the robot's own",
              .unit = skill::kRadian,
              .default_value = std::vector<Range>(axes),
              .extra_check = [axes](const Value& value) {
                  return checkCount<Range>(value, axes, "{} ranges, the arm has {} axes");
              }});
    addMoveFields(fields, model, kind);
    add(fields, &MoveParameters::relative, relativeField(Relative::tool));
}

}  // namespace

Range jointRangeOf(const motion::RobotModel& model) {
    Range range = kUsualJointRange;
    for (std::size_t axis = 0; axis < model.axisCount(); ++axis) {
        range.low = std::min(range.low, model.limits(axis).lower);
        range.high = std::max(range.high, model.limits(axis).upper);
    }
    return range;
}

skill::FieldList<CartesianMoveParameters> cartesianMoveFields(const motion::RobotModel& model,
                                                              MoveKind kind) {
    skill::FieldList<CartesianMoveParameters> fields;
    addCartesianFields(fields, model, kind);
    if (kind == MoveKind::ptp) {
        fields.add(&CartesianMoveParameters::next_position, nextPositionField());
    }
    return fields;
}

skill::FieldList<ForceMoveParameters> forceMoveFields(const motion::RobotModel& model) {
    skill::FieldList<ForceMoveParameters> fields;
    addCartesianFields(fields, model, MoveKind::linear);
    fields.add(&ForceMoveParameters::max_force, maxForceField());
    fields.add(&ForceMoveParameters::halt_on_force, haltOnForceField());
    return fields;
}

skill::FieldList<PathMoveParameters> pathMoveFields(const motion::RobotModel& model) {
    skill::FieldList<PathMoveParameters> fields;
    fields.add(&PathMoveParameters::poses,
               Field{.name = "Poses",
                     .description =
                         "Poses of the tool frame to pass, in the base frame; the last one is the "
                         "target",
                     .length = skill::LengthLimit{1, kMostPoses}});
    fields.add(&PathMoveParameters::blend_radii,
               Field{.name = "BlendRadii",
                     .description =
                         "Largest distance from each pose at which its corner may be cut, over 0; "
                         "one per pose, the last one is not used",
                     .unit = skill::kMetre,
                     .range = Range{0.0, kLongestRadius},
                     .default_value = std::vector<double>()});
    fields.add(&PathMoveParameters::speeds,
               Field{.name = "Speeds",
                     .description =
                         "Largest speed on the way to each pose; 0: MaxVelocity; one per pose, or "
                         "none",
                     .unit = skill::kMetrePerSecond,
                     .range = Range{0.0, kHighestSpeed},
                     .default_value = std::vector<double>()});
    addMoveFields(fields, model, MoveKind::linear);
    add(fields, &MoveParameters::relative, relativeField(Relative::tool));
    return fields;
}

skill::FieldList<JointMoveParameters> jointMoveFields(const motion::RobotModel& model,
                                                      MoveKind kind) {
    skill::FieldList<JointMoveParameters> fields;
    const auto axes = model.axisCount();
    fields.add(&JointMoveParameters::target_joint_position,
               Field{.name = "TargetJointPosition",
                     .description = "Joint position to move to, axis 1 first",
                     .unit = skill::kRadian,
                     .range = jointRangeOf(model),
                     .length = skill::LengthLimit{axes, axes}});
    addMoveFields(fields, model, kind);
    add(fields, &MoveParameters::relative, relativeField(Relative::base));
    return fields;
}

}  // namespace metier::robot_skills
