#include "server/event_watch.hpp"

#include <algorithm>

namespace metier::opcua {

void EventWatch::sessionOn(const NodeId& session, ConnectionId connection) {
    sessions_[session].connection = connection;
}

void EventWatch::sessionClosed(const NodeId& session) {
    const auto found = sessions_.find(session);
    if (found == sessions_.end()) {
        return;
    }
    found->second.open = false;
    if (found->second.items == 0) {
        sessions_.erase(found);
    }
}

void EventWatch::added(const NodeId& notifier, const NodeId& session) {
    auto& watchers = watchers_[notifier];
    auto known = std::find_if(watchers.begin(), watchers.end(),
                              [&](const Watcher& each) { return each.session == session; });
    if (known == watchers.end()) {
        known = watchers.insert(watchers.end(), Watcher{session, 0});
    }
    ++known->items;
    ++sessions_[session].items;
}

void EventWatch::removed(const NodeId& notifier, const NodeId& session) {
    const auto watched = watchers_.find(notifier);
    if (watched == watchers_.end()) {
        return;
    }
    auto& watchers = watched->second;
    const auto owns = [&](const Watcher& each) {
        return session.isNull() ? !sessions_[each.session].open : each.session == session;
    };
    const auto watcher = std::find_if(watchers.begin(), watchers.end(), owns);
    if (watcher == watchers.end()) {
        return;
    }
    const auto owner = sessions_.find(watcher->session);
    if (owner != sessions_.end() && --owner->second.items == 0 && !owner->second.open) {
        sessions_.erase(owner);
    }
    if (--watcher->items == 0) {
        watchers.erase(watcher);
    }
    if (watchers.empty()) {
        watchers_.erase(watched);
    }
}

bool EventWatch::watchesAny(std::span<const NodeId> notifiers) const {
    return std::any_of(notifiers.begin(), notifiers.end(),
                       [this](const NodeId& notifier) { return watchers_.contains(notifier); });
}

std::span<const ConnectionId> EventWatch::connectionsOf(std::span<const NodeId> notifiers) {
    found_.clear();
    for (const auto& notifier : notifiers) {
        const auto watched = watchers_.find(notifier);
        if (watched == watchers_.end()) {
            continue;
        }
        for (const auto& watcher : watched->second) {
            const auto connection = sessions_[watcher.session].connection;
            if (std::find(found_.begin(), found_.end(), connection) == found_.end()) {
                found_.push_back(connection);
            }
        }
    }
    return found_;
}

}  // namespace metier::opcua
