#pragma once

#include <vector>

#include "metier/motion/planner.hpp"
#include "speed_bounds.hpp"
#include "tool_path.hpp"

namespace metier::motion {

/// The robot's own limit, or a lower one that was asked for; 0 asks for nothing.
inline double capped(double requested, double own) noexcept {
    return requested > 0 && requested < own ? requested : own;
}

/// Limits of the path parameter on a single line.
ScalarLimits limitsOfLine(const RobotModel& model, const LinRequest& request, const ToolPath& line);

/// Adds what the tool frame may do at the knots of a path with corners.
/// \return the largest speed of the path parameter that it allows anywhere [1/s]
double addToolBounds(const RobotModel& model, const PathRequest& request, const JointPath& path,
                     std::vector<SpeedBounds>& bounds);

}  // namespace metier::motion
