#pragma once

#include <functional>

#include "metier/base/clock.hpp"
#include "rosbridge.hpp"

namespace metier::virtual_edo {

/// Adds the services of the node rosapi, by which clients look around: topics, services, types and
/// the time.
///
/// \param graph must stay at its address as long as it is served; entries added later are served,
/// too
/// Source: RobotWebTools/rosbridge_suite (ROS 1), rosapi/srv/*.srv and scripts/rosapi_node, which
///         rosbridge_websocket.launch starts.
void serveRosApi(RosGraph& graph, std::function<UtcTime()> now);

}  // namespace metier::virtual_edo
