#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "metier/opcua/node_id.hpp"

namespace metier::opcua {

/// Sessions that were created and not activated yet. They make room for new ones (OPC 10000-4,
/// 5.7.2): a client that creates sessions without end loses its own, the oldest first.
///
/// Threading: one thread.
class UnusedSessions {
public:
    void created(const NodeId& id, std::uintptr_t connection);
    /// Activated, or closed.
    void gone(const NodeId& id);
    std::size_t count() const noexcept { return sessions_.size(); }
    /// The oldest one of the connection that created most of them; none: there are none.
    std::optional<NodeId> surplus() const;

private:
    struct Unused {
        NodeId id;
        std::uintptr_t connection = 0;
    };
    std::vector<Unused> sessions_;  // oldest first
};

}  // namespace metier::opcua
