#include "moves/move_skill.hpp"

#include <fmt/format.h>

namespace metier::robot_skills {

skill::SkillDescription describeMove(std::string name, std::string description) {
    return {.name = name,
            .type = name + "Type",
            .description = std::move(description),
            .on_owner_loss = skill::OwnerLossAction::halt};
}

Result<std::optional<motion::JointVector>> startIn(const skill::ArmPositions& starts,
                                                   const MovedArm& arm) {
    const auto own = starts.find("");
    if (own == starts.end()) {
        return std::nullopt;
    }
    const auto& joints = own->second;
    if (joints.size() != arm.model.axisCount()) {
        return fail(Errc::invalid_argument,
                    fmt::format("StartJointPosition: {} values expected, {} given",
                                arm.model.axisCount(), joints.size()));
    }
    METIER_ASSIGN(const auto start, motion::JointVector::from(joints));
    return start;
}

skill::CheckReport reportOf(const motion::Planned<motion::Trajectory>& plan) {
    constexpr std::size_t preview_points = 50;
    const auto feasibility = motion::assess(plan, preview_points);
    skill::CheckReport report;
    if (feasibility.refusal) {
        report.possible = false;
        report.reason = feasibility.refusal->error.message;
        report.code = toString(feasibility.refusal->error.code);
        report.first_failing_fraction = feasibility.refusal->fraction;
        return report;
    }
    report.planned_duration = feasibility.duration.count();
    report.stopping_time = feasibility.longest_stop.time.count();
    report.stopping_distance = feasibility.longest_stop.distance;
    for (const auto& joints : feasibility.preview) {
        report.joint_path.emplace_back(joints.begin(), joints.end());
    }
    const auto end = plan->end();
    report.ends_known = true;
    report.ends[""].assign(end.begin(), end.end());
    return report;
}

}  // namespace metier::robot_skills
