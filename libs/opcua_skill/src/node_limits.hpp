#pragma once

#include <cstdint>
#include <vector>

#include "metier/opcua/address_space.hpp"
#include "metier/skill/field.hpp"
#include "node_role.hpp"

namespace metier::opcua_skill {

/// Limits of parameters that only their nodes have, as the EURange of a frame's coordinates.
///
/// Threading: the server's thread.
class NodeLimits {
public:
    /// Takes over the EURange of a parameter's node, if it has one.
    void add(const opcua::AddressSpace& nodes, const opcua::NodeId& node, NodeRole node_role);
    /// Errors: out_of_range, with field, part, value, limits and unit.
    Result<void> check(std::uint16_t index, const skill::Field& field,
                       const skill::Value& value) const;

private:
    struct Limit {
        std::uint16_t field = 0;
        Part part{};
        Range range;
    };
    std::vector<Limit> limits_;
};

}  // namespace metier::opcua_skill
