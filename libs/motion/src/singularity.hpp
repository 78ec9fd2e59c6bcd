#pragma once

#include <optional>
#include <vector>

#include "metier/motion/planner.hpp"
#include "speed_map.hpp"

namespace metier::motion {

/// Refuses a path on which the arm loses a direction that the path needs.
/// \param knots joint positions at equal steps of the path parameter
std::optional<Refusal> refuseSingular(const RobotModel& model,
                                      const std::vector<JointVector>& knots,
                                      const PlannerOptions& options);

/// Refuses a path that an axis would make too slow to be meant.
/// \param speed requested, of the path parameter [1/s]
std::optional<Refusal> refuseCrawling(const RobotModel& model,
                                      const std::vector<SpeedBounds>& bounds, double speed,
                                      const PlannerOptions& options);

}  // namespace metier::motion
