#pragma once

#include <optional>

#include "metier/motion/planner.hpp"
#include "tool_path.hpp"

namespace metier::motion {

/// base_from_tool that a target stands for.
motion::Pose absoluteTarget(const motion::Pose& start, const motion::Pose& target,
                            TargetReference reference);

/// Makes `path` the one of the tool frame from the start through all waypoints.
/// \return why there is none, naming the waypoint
std::optional<Refusal> layOut(const RobotModel& model, const PathRequest& request,
                              const motion::Pose& flange_from_tool, ToolPath& path);

/// The refusal of a place of `path`, naming the waypoint that it is on the way to if there are
/// several.
Refusal onTheWay(Refusal refusal, const ToolPath& path, const PathRequest& request);

}  // namespace metier::motion
