#pragma once

#include <memory>

#include "metier/base/error.hpp"
#include "metier/cell/cell.hpp"
#include "metier/server/server.hpp"

namespace metier::server {

// Each starts a server of one kind, as start() does. The second argument is of `config`.

/// An arm with its skills: at the instances of its NodeSet, and at nodes made at run time for those
/// that the NodeSet does not have.
/// Errors: what is wrong with the model, the driver, the NodeSet, the skills or the port.
Result<std::unique_ptr<Server>> serve(const cell::ServerConfig& config, const cell::ArmServer& arm,
                                      const Context& context);

/// A gripper: the instances of its NodeSet, served by its skills.
/// Errors: what is wrong with the driver, the NodeSet, the skills or the port.
Result<std::unique_ptr<Server>> serve(const cell::ServerConfig& config,
                                      const cell::GripperServer& gripper, const Context& context);

/// The move skills over the position stream of another server, whatever its robot is. If a robot is
/// to be found, it waits for one, 20 s at most.
/// Errors: the robot's server cannot be reached or does not publish enough; the port is taken;
/// cancelled (a stop was asked for).
Result<std::unique_ptr<Server>> serve(const cell::ServerConfig& config,
                                      const cell::MoveComponent& move, const Context& context);

/// Skills that files declare, made of skills of other servers and of each other. With `servers =
/// "discover"` it waits up to 20 s until all used skills are found.
/// Errors: mistakes in the files; a used skill server that cannot be reached; a used skill that no
/// server has or, unless discovered, more than one; the port; cancelled (a stop was asked for while
/// it waited).
Result<std::unique_ptr<Server>> serve(const cell::ServerConfig& config,
                                      const cell::CompositionServer& composition,
                                      const Context& context);

/// SynchronizedMoveSkill over the arms of other servers.
/// Errors: a used skill server that cannot be reached, or has no arm, or several, whose moves take
/// a start time; the port.
Result<std::unique_ptr<Server>> serve(const cell::ServerConfig& config,
                                      const cell::SynchronizedServer& arms, const Context& context);

}  // namespace metier::server
