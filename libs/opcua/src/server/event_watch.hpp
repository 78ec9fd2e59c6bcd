#pragma once

#include <span>
#include <unordered_map>
#include <vector>

#include "event_loop/event_loop.hpp"
#include "metier/opcua/node_id.hpp"

namespace metier::opcua {

/// Which connection has a monitored item for the events of which Object.
///
/// Threading: the server's thread.
class EventWatch {
public:
    /// A session was activated on a connection, or again on another.
    void sessionOn(const NodeId& session, ConnectionId connection);
    /// A session ended; its Subscriptions may live on for another to take over.
    void sessionClosed(const NodeId& session);
    void added(const NodeId& notifier, const NodeId& session);
    /// \param session null if the item's Subscription had none any more
    void removed(const NodeId& notifier, const NodeId& session);

    bool empty() const noexcept { return watchers_.empty(); }
    /// Whether any of these has a monitored item.
    bool watchesAny(std::span<const NodeId> notifiers) const;
    /// The connections that watch any of these, each once; valid until the next call.
    std::span<const ConnectionId> connectionsOf(std::span<const NodeId> notifiers);

private:
    struct Watcher {
        NodeId session;
        std::size_t items = 0;
    };
    struct SessionState {
        ConnectionId connection = 0;
        bool open = true;
        std::size_t items = 0;
    };

    std::unordered_map<NodeId, std::vector<Watcher>> watchers_;
    std::unordered_map<NodeId, SessionState> sessions_;
    std::vector<ConnectionId> found_;
};

}  // namespace metier::opcua
