#include "metier/robot_skills/stopping_report.hpp"

#include <algorithm>
#include <cmath>

#include "conversions.hpp"

namespace metier::robot_skills {

motion::StoppingEstimate stoppingEstimateOf(const device::ArmState& state,
                                            const motion::RobotModel& model) {
    motion::StoppingEstimate way;
    if (state.standstill || state.velocity.size() != model.axisCount() ||
        state.position.size() != model.axisCount()) {
        return way;
    }
    auto end = toVector(state.position);
    for (std::size_t axis = 0; axis < model.axisCount(); ++axis) {
        const auto& limits = model.limits(axis);
        const double speed = std::abs(state.velocity[axis]);
        // A short stop does not come to the full deceleration.
        const double time = speed * limits.jerk < limits.acceleration * limits.acceleration
                                ? 2.0 * std::sqrt(speed / limits.jerk)
                                : speed / limits.acceleration + limits.acceleration / limits.jerk;
        end[axis] += 0.5 * state.velocity[axis] * time;
        way.time = std::max(way.time, motion::Seconds(time));
    }
    const auto& kinematics = model.kinematics();
    way.distance = motion::distanceBetween(kinematics.forward(toVector(state.position)),
                                           kinematics.forward(end));
    return way;
}

}  // namespace metier::robot_skills
