#include "moves/acceleration_phase.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "metier/base/numbers.hpp"
#include "moves/controller_planned_motion.hpp"

namespace metier::robot_skills {

namespace {

// Noise of a measured velocity [rad/s].
constexpr double kNoise = 5e-3;
// An arm whose speed has not risen for so long has ended its acceleration [s].
constexpr double kSteady = 0.05;

double fastestAxis(const device::JointArray& velocity) noexcept {
    double fastest = 0.0;
    for (const double speed : velocity) {
        fastest = std::max(fastest, std::abs(speed));
    }
    return fastest;
}

}  // namespace

AccelerationPhase::AccelerationPhase(const motion::RobotModel& model, motion::Trajectory trajectory,
                                     double cycle)
    : model_(model),
      trajectory_(std::move(trajectory)),
      cycle_(cycle),
      top_speed_(plannedPathSpeed(trajectory_)) {}

void AccelerationPhase::restart() noexcept {
    reference_ = 0.0;
    unchanged_ = 0.0;
}

device::JointArray AccelerationPhase::take(const device::ArmState& state, double place) noexcept {
    device::JointArray most(model_.axisCount());
    const auto way = trajectory_.sampleOnPath({place, 1.0, 0.0}).velocity;
    const double square = way.view().squaredNorm();
    if (!maySpeedUp(state) || square == 0.0 || state.velocity.size() != most.size()) {
        return most;
    }
    double speed = 0.0;
    double acceleration = kInfinity;
    double jerk = acceleration;
    for (std::size_t axis = 0; axis < most.size(); ++axis) {
        speed += state.velocity[axis] * way[axis] / square;
        acceleration =
            std::min(acceleration, model_.limits(axis).acceleration / std::abs(way[axis]));
        jerk = std::min(jerk, model_.limits(axis).jerk / std::abs(way[axis]));
    }
    const double missing = std::max(0.0, top_speed_ - speed);
    acceleration = std::min(acceleration, std::sqrt(2.0 * jerk * missing));
    for (std::size_t axis = 0; axis < most.size(); ++axis) {
        most[axis] = acceleration * way[axis];
    }
    return most;
}

bool AccelerationPhase::maySpeedUp(const device::ArmState& state) noexcept {
    const double speed = fastestAxis(state.velocity);
    if (std::abs(speed - reference_) > kNoise) {
        unchanged_ = speed > reference_ ? 0.0 : kSteady;
        reference_ = speed;
    } else if (!state.standstill) {
        unchanged_ += cycle_;
    }
    return unchanged_ < kSteady;
}

}  // namespace metier::robot_skills
