#pragma once

#include <string>

#include "controller_planned_run.hpp"
#include "metier/device/motion_planner.hpp"

namespace metier::iiwa_driver {

/// Outcome of a controller-planned motion for its caller.
/// \param name of the device, for texts
/// \param lost why the connection is gone, for texts
/// Errors: device_fault, connection_lost
Result<device::MotionOutcome> outcomeOf(const RunEnd& end, const std::string& name,
                                        const std::string& lost);

}  // namespace metier::iiwa_driver
