#include "metier/robot_skills/move_parameters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>
#include <string_view>
#include <utility>

namespace metier::robot_skills {

using skill::Field;
using skill::Place;
using skill::Range;
using skill::Value;

namespace {

constexpr std::size_t kCartesianDimensions = 6;

/// Accepts all zero of any length, else exactly `count` values.
Result<void> checkMaximum(const std::vector<double>& values, std::size_t count) {
    const bool not_set = std::all_of(values.begin(), values.end(), [](double v) { return v == 0; });
    if (not_set) {
        return {};
    }
    if (values.size() != count) {
        return fail(Errc::out_of_range,
                    fmt::format("{} values, expected {} or all zero", values.size(), count));
    }
    return {};
}

Result<void> checkBounds(const std::vector<Range>& bounds, std::size_t axis_count) {
    const bool not_set = std::all_of(bounds.begin(), bounds.end(),
                                     [](const Range& r) { return r.low == 0 && r.high == 0; });
    if (not_set) {
        return {};
    }
    if (bounds.size() != axis_count) {
        return fail(Errc::out_of_range,
                    fmt::format("{} ranges, the arm has {} axes", bounds.size(), axis_count));
    }
    return {};
}

struct Maximum {
    std::string name;
    std::size_t count;
    double highest;
    skill::Unit unit;
};

Field maximumField(const Maximum& maximum, std::string description) {
    const auto& [name, count, highest, unit] = maximum;
    Field field{.name = name, .description = std::move(description), .unit = unit};
    field.range = Range{0.0, highest};
    field.default_value = std::vector<double>(count, 0.0);
    field.extra_check = [count = count](const Value& value) {
        return checkMaximum(std::get<std::vector<double>>(value), count);
    };
    return field;
}

Field toolFrameField(const motion::RobotModel& model) {
    Field field{.name = "ToolFrame",
                .description = "Name of the tool frame that is moved; empty: the flange"};
    field.default_value = std::string();
    field.extra_check = [&model](const Value& value) -> Result<void> {
        if (auto tool = model.tool(std::get<std::string>(value)); !tool) {
            return fail(std::move(tool.error()));
        }
        return {};
    };
    return field;
}

Field relativeField(Relative last) {
    Field field{.name = "Relative",
                .description =
                    "What the target is relative to: 0 absolute, 1 along the base axes "
                    "or to the joint position, 2 along the axes of the tool frame"};
    field.place = Place::options;
    field.default_value = std::int32_t{0};
    field.range = Range{0.0, static_cast<double>(last)};
    return field;
}

Field blendRadiusField() {
    Field field{.name = "BlendRadius",
                .description = "Radius of the blend into the next move; only 0 so far",
                .unit = skill::kMetre};
    field.place = Place::options;
    field.default_value = 0.0;
    field.extra_check = [](const Value& value) -> Result<void> {
        if (const double radius = std::get<double>(value); radius != 0.0) {
            return fail(Errc::not_supported,
                        fmt::format("{} m; a single move takes 0 m only", radius));
        }
        return {};
    };
    return field;
}

Field speedOverrideField() {
    Field field{.name = "SpeedOverride",
                .description = "Share of the planned speed, over 0 up to 1"};
    field.place = Place::options;
    field.default_value = 1.0;
    field.range = Range{0.0, 1.0};
    field.extra_check = [](const Value& value) -> Result<void> {
        if (std::get<double>(value) <= 0.0) {
            return fail(Errc::out_of_range, "0 would never arrive; over 0 up to 1");
        }
        return {};
    };
    return field;
}

Field redundancyField() {
    Field field{.name = "RedundancyAngle",
                .description =
                    "Angle of the elbow of a seven-axis arm at the target; "
                    "not set: as at the start; other arms ignore it",
                .unit = skill::kRadian};
    field.place = Place::options;
    field.range = Range{-std::numbers::pi, std::numbers::pi};
    return field;
}

Field maxForceField() {
    Field field{.name = "MaxForce",
                .description =
                    "Force along each axis of the base frame that ends the motion; 0: "
                    "no limit along this axis",
                .unit = skill::kNewton};
    field.range = Range{0.0, 1000.0};
    field.extra_check = [](const Value& value) -> Result<void> {
        if (std::get<skill::Vector3>(value) == skill::Vector3{}) {
            return fail(Errc::out_of_range, "no axis has a limit over 0 N");
        }
        return {};
    };
    return field;
}

Field haltOnForceField() {
    Field field{.name = "HaltOnForce",
                .description =
                    "Whether a force over its limit is an error: Halted, instead of "
                    "finished with what was met"};
    field.place = Place::options;
    field.default_value = false;
    return field;
}

/// FieldList::add() for a member that Parameters inherits.
template <typename Parameters, typename Base, typename Member>
void add(skill::FieldList<Parameters>& fields, Member Base::*member, Field field) {
    Member Parameters::*own = member;
    fields.add(own, std::move(field));
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
                  return checkBounds(std::get<std::vector<Range>>(value), axes);
              }});
    addMoveFields(fields, model, kind);
    add(fields, &MoveParameters::relative, relativeField(Relative::tool));
}

template <typename Results>
void addMoveResults(skill::FieldList<Results>& list) {
    add(list, &MoveResults::reached_pose,
        Field{.name = "ReachedPose",
              .description = "Measured pose of the tool frame in the base frame",
              .unit = skill::kMetre});
    add(list, &MoveResults::reached_joint_position,
        Field{.name = "ReachedJointPosition",
              .description = "Measured joint position",
              .unit = skill::kRadian});
    add(list, &MoveResults::duration,
        Field{.name = "Duration",
              .description = "Time in motion, without the time suspended",
              .unit = skill::kSecond});
    add(list, &MoveResults::largest_path_deviation,
        Field{.name = "LargestPathDeviation",
              .description = "Largest distance of the measured tool frame from its path",
              .unit = skill::kMetre});
}

void addForceResults(skill::FieldList<ForceMoveResults>& list) {
    list.add(&ForceMoveResults::contact_force,
             Field{.name = "ContactForce",
                   .description = "Force at the end of the motion, in the base frame",
                   .unit = skill::kNewton});
    list.add(&ForceMoveResults::contact_torque,
             Field{.name = "ContactTorque",
                   .description = "Torque at the end of the motion, in the base frame",
                   .unit = skill::kNewtonMetre});
    list.add(&ForceMoveResults::forces_exceeded,
             Field{.name = "ForcesExceeded",
                   .description = "Force that ended the motion, in the base frame; zero: none did",
                   .unit = skill::kNewton});
    list.add(&ForceMoveResults::forces_max,
             Field{.name = "ForcesMax",
                   .description = "Largest force along each axis of the base frame",
                   .unit = skill::kNewton});
}

}  // namespace

skill::FieldList<CartesianMoveParameters> cartesianMoveFields(const motion::RobotModel& model,
                                                              MoveKind kind) {
    skill::FieldList<CartesianMoveParameters> fields;
    addCartesianFields(fields, model, kind);
    return fields;
}

skill::FieldList<ForceMoveParameters> forceMoveFields(const motion::RobotModel& model) {
    skill::FieldList<ForceMoveParameters> fields;
    addCartesianFields(fields, model, MoveKind::linear);
    fields.add(&ForceMoveParameters::max_force, maxForceField());
    fields.add(&ForceMoveParameters::halt_on_force, haltOnForceField());
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
                     .length = skill::LengthLimit{axes, axes}});
    addMoveFields(fields, model, kind);
    add(fields, &MoveParameters::relative, relativeField(Relative::base));
    return fields;
}

const skill::FieldList<MoveResults>& moveResultFields() {
    static const auto fields = [] {
        skill::FieldList<MoveResults> list;
        addMoveResults(list);
        return list;
    }();
    return fields;
}

const skill::FieldList<ForceMoveResults>& forceMoveResultFields() {
    static const auto fields = [] {
        skill::FieldList<ForceMoveResults> list;
        addMoveResults(list);
        addForceResults(list);
        return list;
    }();
    return fields;
}

}  // namespace metier::robot_skills
