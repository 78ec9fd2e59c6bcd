#pragma once

#include <unordered_map>

#include "metier/opcua/audit.hpp"
#include "metier/opcua/event_emitter.hpp"

namespace metier::opcua {

/// The audit events of OPC 10000-5, raised by the Server object, for those who may have them.
///
/// Threading: the server's thread; must not outlive the stack's server.
class AuditEvents {
public:
    explicit AuditEvents(ServerCore& core) : core_(core) {}
    void emit(const AuditRecord& record);

private:
    EventEmitter* emitterOf(const NodeId& type, const std::vector<BrowsePath>& fields);

    ServerCore& core_;
    std::unordered_map<NodeId, EventEmitter> emitters_;  ///< made when first needed
};

}  // namespace metier::opcua
