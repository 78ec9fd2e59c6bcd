#pragma once

#include <vector>

#include "metier/motion/planner.hpp"
#include "path.hpp"
#include "request_check.hpp"
#include "speed_bounds.hpp"

namespace metier::motion {

/// A path that has been followed, with what bounds the speed at its knots.
struct TrackedPath {
    JointPath joints;
    std::vector<SpeedBounds> bounds;
};

/// Refuses a path on which the arm loses a direction that the path needs.
Checked refuseSingular(const RobotModel& model, const JointPath& path,
                       const PlannerOptions& options);

/// Refuses a path that an axis would make too slow to be meant.
/// \param speed requested, of the path parameter [1/s]
Checked refuseCrawling(const RobotModel& model, const TrackedPath& path, double speed,
                       const PlannerOptions& options);

}  // namespace metier::motion
