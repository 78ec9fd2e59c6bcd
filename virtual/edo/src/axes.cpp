#include "axes.hpp"

namespace metier::virtual_edo {

AxisLimits limitsOf(const motion::RobotModel& model) {
    AxisLimits limits{};
    for (std::size_t axis = 0; axis < kArmAxes; ++axis) {
        const auto& of_model = model.limits(axis);
        limits[axis] = {.lower = of_model.lower / kDegree,
                        .upper = of_model.upper / kDegree,
                        .velocity = of_model.velocity / kDegree,
                        .acceleration = of_model.acceleration / kDegree};
    }
    // Stroke of pyedo; speed and ramp (200 ms) are assumed.
    limits[kGripper] = {.lower = 0.0, .upper = 80.0, .velocity = 40.0, .acceleration = 200.0};
    return limits;
}

motion::JointVector armRadians(const AxisValues& values) {
    motion::JointVector radians(kArmAxes);
    for (std::size_t axis = 0; axis < kArmAxes; ++axis) {
        radians[axis] = values[axis] * kDegree;
    }
    return radians;
}

void setArm(AxisValues& values, const motion::JointVector& radians) {
    for (std::size_t axis = 0; axis < kArmAxes; ++axis) {
        values[axis] = radians[axis] / kDegree;
    }
}

}  // namespace metier::virtual_edo
