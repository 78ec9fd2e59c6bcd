#include "moves/move_skill.hpp"

namespace metier::robot_skills {

skill::SkillDescription describeMove(std::string name, std::string description) {
    return {.name = name,
            .type = name + "Type",
            .description = std::move(description),
            .on_owner_loss = skill::OwnerLossAction::halt};
}

skill::CheckReport reportOf(const motion::Planned<motion::Trajectory>& plan) {
    constexpr std::size_t preview_points = 50;
    const auto feasibility = motion::assess(plan, preview_points);
    skill::CheckReport report;
    if (feasibility.refusal) {
        report.possible = false;
        report.reason = feasibility.refusal->error.message;
        report.first_failing_fraction = feasibility.refusal->fraction;
        return report;
    }
    report.planned_duration = feasibility.duration.count();
    report.stopping_time = feasibility.longest_stop.time.count();
    report.stopping_distance = feasibility.longest_stop.distance;
    for (const auto& joints : feasibility.preview) {
        report.joint_path.emplace_back(joints.begin(), joints.end());
    }
    return report;
}

}  // namespace metier::robot_skills
