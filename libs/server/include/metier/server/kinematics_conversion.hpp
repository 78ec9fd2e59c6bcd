#pragma once

#include <vector>

#include "metier/base/error.hpp"
#include "metier/motion/chain.hpp"
#include "metier/motion/robot_model.hpp"
#include "metier/opcua_skill/kinematics_data.hpp"

namespace metier::server {

/// Converts a robot model to the kinematics that its server publishes. Threads: any; pure.
opcua_skill::KinematicsData toKinematicsData(const motion::RobotModel& model);

/// Converts published kinematics to the description of a chain.
/// \param current joint position [rad]; used as home position, which is not published
/// Errors: not_supported (more axes than motion can plan for), invalid_argument (not finite).
/// Threads: any; pure.
Result<motion::ChainDescription> toChain(const opcua_skill::KinematicsData& data,
                                         const std::vector<double>& current);

}  // namespace metier::server
