#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "metier/base/numbers.hpp"
#include "metier/motion/robot_model.hpp"

namespace metier::virtual_edo {

inline constexpr std::size_t kArmAxes = 6;
inline constexpr std::size_t kGripper = 6;  ///< index of axis 7
inline constexpr std::size_t kMostAxes = 7;

/// The robot's cycle.
inline constexpr std::chrono::milliseconds kCycle{10};
inline constexpr double kCycleSeconds = 0.01;

/// One value per axis: [deg], the gripper's [mm].
using AxisValues = std::array<double, kMostAxes>;

/// [deg], [deg/s], [deg/s2]; the gripper's [mm], [mm/s], [mm/s2].
struct AxisLimit {
    double lower = 0.0;
    double upper = 0.0;
    double velocity = 0.0;
    double acceleration = 0.0;
};
using AxisLimits = std::array<AxisLimit, kMostAxes>;

/// The arm's limits from its model, the gripper's as Comau gives them.
AxisLimits limitsOf(const motion::RobotModel& model);

/// The arm's six axes [rad].
motion::JointVector armRadians(const AxisValues& values);
/// Puts six axes [rad] into `values`; the gripper's stays.
void setArm(AxisValues& values, const motion::JointVector& radians);

/// Reports whether the axis (from 0) is in the mask.
constexpr bool inMask(std::uint64_t mask, std::size_t axis) {
    return ((mask >> axis) & 1U) != 0;
}

/// The mask of the first `count` axes.
constexpr std::uint64_t maskOf(std::size_t count) {
    return (std::uint64_t{1} << count) - 1;
}

}  // namespace metier::virtual_edo
