#pragma once

#include "metier/motion/planner.hpp"
#include "path.hpp"
#include "request_check.hpp"

namespace metier::motion {

/// What a joint path along a tool path is found with.
struct TrackRequest {
    const RobotModel* model = nullptr;
    FlangePath path;
    JointVector start;
    AxisBounds bounds;
    std::optional<double> end_arm_angle;  ///< of an arm that has one; else kept or moved if needed
};

/// The joint path along the tool path without jumps, or where and why there is none.
Planned<JointPath> trackLine(const TrackRequest& request);

}  // namespace metier::motion
