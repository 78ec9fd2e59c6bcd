#pragma once

#include <memory>
#include <optional>
#include <string>

#include "host/skill_host.hpp"
#include "metier/base/error.hpp"
#include "metier/cell/cell.hpp"
#include "metier/client/remote_arm.hpp"
#include "metier/motion/robot_model.hpp"
#include "metier/server/identity.hpp"
#include "metier/skill/execution_names.hpp"

namespace metier::server {

/// A robot behind another server, and the model by which moves are planned for it.
struct ConnectedRobot {
    std::string url;
    std::unique_ptr<client::RemoteArm> arm;
    motion::RobotModel model;
};

/// Connects to the robot of `move`, by its model file if its server publishes no Kinematics.
/// \param url of the robot's server; another one than that of `move` if it was found
/// Errors: the server cannot be reached, or does not publish enough; mistakes in the model file.
Result<ConnectedRobot> connectRobot(const std::string& url, const cell::MoveComponent& move,
                                    const Identity& identity);

/// An OPC UA server with the move skills of one robot, over its position stream.
///
/// Threading: one thread at a time.
class RobotMoves {
public:
    /// \param names of executions that the server had before with another robot, shared with its
    ///              Programs; null: those of its state folder
    /// Errors: the port is taken.
    static Result<std::unique_ptr<RobotMoves>> serve(const cell::ServerConfig& config,
                                                     const Identity& identity, ConnectedRobot robot,
                                                     std::shared_ptr<skill::ExecutionNames> names);

    const ConnectedRobot& robot() const noexcept { return robot_; }
    const SkillHost& host() const noexcept { return *host_; }

private:
    RobotMoves(ConnectedRobot robot, std::unique_ptr<SkillHost> host);
    Result<void> offer(const std::string& name);

    ConnectedRobot robot_;
    std::unique_ptr<SkillHost> host_;  // ends before the robot that its skills move
};

}  // namespace metier::server
