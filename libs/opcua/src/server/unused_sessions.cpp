#include "server/unused_sessions.hpp"

#include <map>

namespace metier::opcua {

void UnusedSessions::created(const NodeId& id, std::uintptr_t connection) {
    sessions_.push_back({id, connection});
}

void UnusedSessions::gone(const NodeId& id) {
    std::erase_if(sessions_, [&](const Unused& session) { return session.id == id; });
}

std::optional<NodeId> UnusedSessions::surplus() const {
    std::map<std::uintptr_t, std::size_t> counts;
    for (const auto& session : sessions_) {
        ++counts[session.connection];
    }
    const Unused* surplus = nullptr;
    for (const auto& session : sessions_) {
        if (surplus == nullptr || counts[session.connection] > counts[surplus->connection]) {
            surplus = &session;
        }
    }
    return surplus == nullptr ? std::nullopt : std::optional(surplus->id);
}

}  // namespace metier::opcua
