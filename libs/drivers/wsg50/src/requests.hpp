#pragma once

#include "options.hpp"

namespace metier::wsg50_driver {

/// Facts about the gripper, known since its first connection. Trivially copyable.
struct Known {
    Limits limits{};
    double force_limit = 0.0;  ///< force limit at the first connection [N]; 0: never connected
};

/// The motion that a request stands for, with the driver's settings for what it leaves open.
/// Errors: out_of_range, with value, limit and unit.
Result<Motion> motionFor(MotionKind kind, const device::GripperRequest& request,
                         const Wsg50Options& options, const Known& known);

}  // namespace metier::wsg50_driver
