#pragma once

#include <vector>

#include "metier/base/error.hpp"
#include "metier/motion/chain.hpp"
#include "metier/motion/robot_model.hpp"
#include "metier/opcua_skill/kinematics_data.hpp"

namespace metier::server {

/// Kinematics of a robot as its server publishes them. Threads: any; pure.
opcua_skill::KinematicsData toKinematicsData(const motion::RobotModel& model);

/// The chain of an arm that its server publishes.
/// \param current joint position [rad], as home position, which is not published
/// Errors: not_supported (more axes than motion can plan for), invalid_argument (not finite).
/// Threads: any; pure.
Result<motion::ChainDescription> toChain(const opcua_skill::KinematicsData& data,
                                         const std::vector<double>& current);

}  // namespace metier::server
