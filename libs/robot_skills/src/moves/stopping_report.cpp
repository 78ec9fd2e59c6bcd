#include "metier/robot_skills/stopping_report.hpp"

#include <algorithm>

#include "conversions.hpp"
#include "metier/motion/profile.hpp"

namespace metier::robot_skills {

motion::StoppingEstimate stoppingEstimateOf(const device::ArmState& state,
                                            const motion::RobotModel& model,
                                            const device::JointArray& acceleration) {
    motion::StoppingEstimate way;
    const bool speeds_up = std::any_of(acceleration.begin(), acceleration.end(),
                                       [](double of_axis) { return of_axis != 0.0; });
    const bool rests = state.standstill && !speeds_up;
    if (rests || state.velocity.size() != model.axisCount() ||
        state.position.size() != model.axisCount()) {
        return way;
    }
    auto end = toVector(state.position);
    for (std::size_t axis = 0; axis < model.axisCount(); ++axis) {
        const auto& limits = model.limits(axis);
        const auto stop = motion::Profile::brake(
            {0.0, state.velocity[axis], speeds_up ? acceleration[axis] : 0.0},
            {limits.velocity, limits.acceleration, limits.jerk});
        end[axis] += stop.end();
        way.time = std::max(way.time, motion::Seconds(stop.duration()));
    }
    const auto& kinematics = model.kinematics();
    way.distance = motion::distanceBetween(kinematics.forward(toVector(state.position)),
                                           kinematics.forward(end));
    return way;
}

}  // namespace metier::robot_skills
