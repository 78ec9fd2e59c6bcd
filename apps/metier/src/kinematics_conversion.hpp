#pragma once

#include "metier/base/error.hpp"
#include "metier/motion/chain.hpp"
#include "metier/motion/robot_model.hpp"
#include "metier/opcua_skill/kinematics_data.hpp"

namespace metier::app {

/// What a server publishes of a robot.
opcua_skill::KinematicsData toKinematicsData(const motion::RobotModel& model);

/// What a client makes of it; `current` serves as home position, as none is published.
/// Errors: invalid_argument (more axes than motion can plan for, not finite).
Result<motion::ChainDescription> toChain(const opcua_skill::KinematicsData& data,
                                         const std::vector<double>& current);

}  // namespace metier::app
