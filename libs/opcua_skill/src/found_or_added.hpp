#pragma once

#include "metier/opcua/address_space.hpp"

namespace metier::opcua_skill {

/// The child of `spec.node.parent` that has that BrowseName; made if there is none. Server's
/// thread. Errors: those of AddressSpace::addObject().
inline Result<opcua::NodeId> foundOrAdded(opcua::AddressSpace& nodes,
                                          const opcua::ObjectSpec& spec) {
    if (auto found = nodes.find(spec.node.parent, spec.node.browse_name)) {
        return found;
    }
    return nodes.addObject(spec);
}

}  // namespace metier::opcua_skill
