#pragma once

#include <functional>

#include "metier/opcua_skill/motion_device_system.hpp"

namespace metier::opcua_skill {

/// Serves the values that OPC 40010-1 makes mandatory for a robot, besides those of its axes: its
/// safety state as it is now. A value that no driver reports, such as the temperature of a motor,
/// is BadNoData.
/// Threads: those of AddressSpace. Errors: not_found.
Result<void> publishRobotValues(opcua::AddressSpace& nodes, const MotionDeviceSystem& system,
                                const std::function<KinematicsState()>& state);

}  // namespace metier::opcua_skill
