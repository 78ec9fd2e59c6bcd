#pragma once

#include "metier/base/error.hpp"
#include "metier/opcua/server.hpp"
#include "metier/opcua_skill/motion_device_system.hpp"

namespace metier::opcua_skill {

/// Lets clients write WorldToRobotBase of an arm as a whole: the pose of the robot base frame in
/// the world frame. Its components follow and are not writable. A value that is not finite or
/// outside the EURange of a component is refused with BadOutOfRange; each write, taken or refused,
/// is audited. The pose is kept until the server ends.
///
/// Call it before Server::start(); `server` must outlive its nodes.
/// Errors: not_found, if the motion device has no WorldToRobotBase.
Result<void> serveBasePlacement(opcua::Server& server, const MotionDeviceSystem& system);

}  // namespace metier::opcua_skill
