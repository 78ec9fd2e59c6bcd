#include "field_member.hpp"
#include "metier/robot_skills/move_parameters.hpp"

namespace metier::robot_skills {

using skill::Field;

namespace {

template <typename Results>
skill::FieldList<Results> moveResults() {
    skill::FieldList<Results> list;
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
    add(list, &MoveResults::motion_start_time,
        Field{.name = "MotionStartTime",
              .description =
                  "When the first set-point of the motion was given, by the server's own clock, "
                  "since 1970-01-01 UTC",
              .unit = skill::kSecond});
    add(list, &MoveResults::motion_end_time,
        Field{.name = "MotionEndTime",
              .description = "When its last set-point was given",
              .unit = skill::kSecond});
    add(list, &MoveResults::largest_lateness,
        Field{.name = "LargestLateness",
              .description = "Most that a set-point came before or after its time",
              .unit = skill::kSecond});
    return list;
}

skill::FieldList<ForceMoveResults> forceMoveResults() {
    auto list = moveResults<ForceMoveResults>();
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
    return list;
}

}  // namespace

const skill::FieldList<MoveResults>& moveResultFields() {
    static const auto fields = moveResults<MoveResults>();
    return fields;
}

const skill::FieldList<ForceMoveResults>& forceMoveResultFields() {
    static const auto fields = forceMoveResults();
    return fields;
}

}  // namespace metier::robot_skills
