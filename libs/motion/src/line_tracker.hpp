#pragma once

#include "metier/motion/planner.hpp"
#include "path.hpp"
#include "request_check.hpp"

namespace metier::motion {

/// Parameters of the search for a joint path along a tool path.
struct TrackRequest {
    const RobotModel* model = nullptr;
    FlangePath path;
    JointVector start;
    AxisBounds bounds;
    std::optional<double> end_arm_angle;  ///< arm angle at the end; empty: the present one is kept,
                                          ///< or moved if needed
};

/// The joint path along the tool path without jumps, or where and why there is none.
Planned<JointPath> trackLine(const TrackRequest& request);

}  // namespace metier::motion
