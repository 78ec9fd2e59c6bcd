// Handling of MonitoredItems whose connection or Subscription was lost.
#include <algorithm>
#include <optional>
#include <utility>

#include "client/client_core.hpp"
#include "client/client_subscriptions.hpp"

namespace metier::opcua {

namespace {

constexpr std::uint32_t kMostPublishRequests = 10;

std::optional<NodeId> moved(const NodeId& node, const NamespaceMove& move) {
    const auto index = move(node.namespaceIndex());
    return index ? std::optional(std::visit([&](const auto& id) { return NodeId(*index, id); },
                                            node.identifier()))
                 : std::nullopt;
}

bool moveNode(NodeId& node, const NamespaceMove& move) {
    if (auto there = moved(node, move)) {
        node = std::move(*there);
        return true;
    }
    return false;
}

bool moveFilter(EventFilter& filter, const NamespaceMove& move) {
    for (auto& path : filter.fields) {
        for (auto& name : path) {
            const auto index = move(name.namespace_index);
            if (!index) {
                return false;
            }
            name.namespace_index = *index;
        }
    }
    return !filter.of_type || moveNode(*filter.of_type, move);
}

bool moveItem(EventItem& item, const NamespaceMove& move) {
    return moveNode(item.node, move) && moveFilter(item.filter, move);
}

bool moveItem(DataItem& item, const NamespaceMove& move) {
    return moveNode(item.node, move);
}

}  // namespace

void ClientSubscriptions::interrupt(StatusCode status) {
    resting_ = true;
    resumed_ = nullptr;
    if (std::exchange(renewing_, 0) != 0) {
        subscription_id_ = 0;  // half made; the server ends it after a time
    }
    for (const auto& [handle, item] : items_) {
        item->renewing = false;
    }
    if (!std::exchange(interrupted_, true)) {
        tellInterrupted(status);
    }
}

void ClientSubscriptions::tellInterrupted(StatusCode status) {
    for (const auto& [handle, item] : items_) {
        if (!item->ended && !item->added) {
            tell(handle, EventNotice{EventNotice::Kind::interrupted, {}, status});
            tell(handle, DataValue{{}, status, {}, {}});
        }
    }
}

void ClientSubscriptions::resume(const Return& how, std::function<void()> resumed) {
    resting_ = false;
    creating_ = false;
    wanted_ = kMostPublishRequests;
    resumed_ = std::move(resumed);
    if (how.session_kept && subscription_id_ != 0) {
        goOn();
    } else {
        renew(how.move);
    }
}

/// The Subscription still exists, and sends the notifications that it kept meanwhile.
void ClientSubscriptions::goOn() {
    for (const auto& [handle, item] : items_) {
        if (!item->ended && !item->added) {
            tell(handle, EventNotice{EventNotice::Kind::resumed, {}, {}});
        }
    }
    for (const auto server_id : std::exchange(unwanted_, {})) {
        deleteItem(server_id);
    }
    refill();
    finishResuming();
}

void ClientSubscriptions::renew(const NamespaceMove& move) {
    subscription_id_ = 0;
    unacknowledged_.clear();
    unwanted_.clear();
    for (const auto& [handle, item] : items_) {
        item->server_id = 0;
        if (item->ended || item->added) {
            continue;
        }
        if (std::visit([&](auto& request) { return moveItem(request, move); }, item->request)) {
            item->renewing = true;
            item->deadline = core_.deadline({});
            ++renewing_;
        } else {
            endItem(handle, *item, status::kBadNodeIdUnknown);
        }
    }
    if (renewing_ == 0) {
        finishResuming();
    } else if (!creating_) {
        createSubscription(core_.deadline({}));
    }
}

void ClientSubscriptions::renewed(std::uint32_t handle, Item& item, const Answer<>& outcome) {
    if (!outcome && outcome.error().code == Errc::connection_lost) {
        return;  // interrupt() follows, and another renewal
    }
    item.renewing = false;
    if (outcome) {
        tell(handle, EventNotice{EventNotice::Kind::overflow, {}, {}});
        tell(handle, EventNotice{EventNotice::Kind::resumed, {}, {}});
    } else {
        endItem(handle, item, outcome.error().status);
    }
    oneRenewed();
}

void ClientSubscriptions::oneRenewed() {
    if (renewing_ != 0 && --renewing_ == 0) {
        finishResuming();
    }
}

void ClientSubscriptions::finishResuming() {
    interrupted_ = false;
    if (const auto resumed = std::exchange(resumed_, nullptr)) {
        resumed();
    }
}

/// The server has no such Subscription any more, though the connection holds.
void ClientSubscriptions::lostByServer(StatusCode status) {
    if (!core_.reconnects()) {
        return end(status);
    }
    tellInterrupted(status);
    renew({});
}

}  // namespace metier::opcua
