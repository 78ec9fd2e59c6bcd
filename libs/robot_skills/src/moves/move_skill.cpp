#include "moves/move_skill.hpp"

namespace metier::robot_skills {

namespace {

// Number of points in the joint path that Check returns.
constexpr std::size_t kPreviewPoints = 50;

}  // namespace

ToolDistance toolDistance(const motion::Trajectory& trajectory) {
    return [trajectory](const device::JointArray& a, const device::JointArray& b) {
        return motion::distanceBetween(trajectory.toolPose(toVector(a)),
                                       trajectory.toolPose(toVector(b)));
    };
}

skill::CheckReport reportOf(const motion::Planned<motion::Trajectory>& plan) {
    const auto feasibility = motion::assess(plan, kPreviewPoints);
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
