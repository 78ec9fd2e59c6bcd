#pragma once

#include <memory>
#include <string>

#include "metier/base/error.hpp"
#include "metier/configuration/cell.hpp"
#include "metier/motion/robot_model.hpp"
#include "metier/remote_arm/remote_arm.hpp"
#include "skill_host.hpp"

namespace metier::app {

/// The four move skills over the position stream of another server, whatever its robot is.
///
/// Threading: one thread starts and ends it.
class MoveServer {
public:
    /// Errors: the robot's server cannot be reached or does not tell enough, or the port is taken.
    static Result<std::unique_ptr<MoveServer>> start(const configuration::ServerConfig& config);

    std::string url() const { return host_->url(); }

private:
    MoveServer(motion::RobotModel model, std::unique_ptr<remote_arm::RemoteArm> arm,
               std::unique_ptr<SkillHost> host);
    Result<void> offer(const std::string& name);

    motion::RobotModel model_;
    std::unique_ptr<remote_arm::RemoteArm> arm_;
    std::unique_ptr<SkillHost> host_;
};

}  // namespace metier::app
