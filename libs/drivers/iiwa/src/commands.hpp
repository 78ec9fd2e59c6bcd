#pragma once

#include "metier/device/motion_planner.hpp"
#include "metier/iiwa_driver/wire.hpp"

namespace metier::iiwa_driver {

enum class Interface : std::uint8_t { standard = 31, servo = 32 };
enum class MotionType : std::uint8_t { ptp = 21, line = 22 };

// Commands from values in SI units. Nothing allocates or throws.

/// Only asks for the state.
Command askState() noexcept;
Command cancel() noexcept;
/// \param target [rad]; the cabinet keeps the present angle for what it does not accept
Command moveJoints(const device::JointArray& target) noexcept;
/// \param target of the tool, or of the flange without one, in the base frame
Command movePose(const Frame& target) noexcept;
/// \param share (0, 1]
Command jointVelocity(double share) noexcept;
Command jointAcceleration(double share) noexcept;
/// \param velocity [m/s]
Command lineVelocity(double velocity) noexcept;
/// \param acceleration [m/s2]
Command lineAcceleration(double acceleration) noexcept;
/// \param tolerance of the cabinet's own estimate of the force [N]
Command forceCondition(const device::ForceCondition& condition, double tolerance) noexcept;
Command forceConditionOff() noexcept;
Command chooseInterface(Interface interface) noexcept;
Command chooseMotionType(MotionType type) noexcept;
Command positionControl() noexcept;
Command asynchronousExecution() noexcept;
/// \param index as the station's setup counts; -1 detaches
Command attachTool(int index) noexcept;

/// Name of a command for texts, such as "joint velocity (201)".
std::string describe(const Command& command);

}  // namespace metier::iiwa_driver
