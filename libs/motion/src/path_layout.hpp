#pragma once

#include "metier/motion/planner.hpp"
#include "request_check.hpp"
#include "tool_path.hpp"

namespace metier::motion {

/// base_from_tool that a target stands for.
Pose absoluteTarget(const Pose& start, const Pose& target, TargetReference reference);

/// Makes `path` the one of the tool frame from the start through all waypoints.
/// \return why there is none, naming the waypoint
Checked layOut(const RobotModel& model, const PathRequest& request, const Pose& flange_from_tool,
               ToolPath& path);

/// The refusal of a place of `path`, naming the waypoint that it is on the way to if there are
/// several.
Refusal onTheWay(Refusal refusal, const ToolPath& path, const PathRequest& request);

}  // namespace metier::motion
