#pragma once

#include <functional>
#include <optional>

#include "metier/base/error.hpp"
#include "metier/opcua/address_space.hpp"
#include "metier/opcua/node_id.hpp"

namespace metier::opcua_skill {

/// Adds the Variable PartHeld of namespace `urn:metier:skills` to an object: whether the gripper
/// holds a part now, between the executions of its skills, too. Clients may subscribe to it.
///
/// \param parent the object that the gripper's skills belong to
/// \param held   true with a part, nothing while the gripper cannot be asked: the Variable is then
///               BadNoCommunication. Called on the server's thread; must not wait.
/// Threads: those of AddressSpace.
/// Errors: those of AddressSpace::addVariable().
Result<void> publishPartHeld(opcua::AddressSpace& nodes, const opcua::NodeId& parent,
                             std::function<std::optional<bool>()> held);

}  // namespace metier::opcua_skill
