#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <variant>
#include <vector>

#include "client/client_calls.hpp"
#include "client/client_reconnection.hpp"
#include "client/client_services.hpp"
#include "metier/opcua/client.hpp"

namespace metier::opcua {

class ClientCore;

using EventCallback = std::function<void(const EventNotice&)>;
using DataCallback = std::function<void(const DataValue&)>;

/// A node, the filter for its events, and the callback for them.
struct EventItem {
    NodeId node;
    EventFilter filter;
    EventCallback callback;
};
struct DataItem {
    NodeId node;
    DataFilter filter;
    DataCallback callback;
};
using ItemRequest = std::variant<EventItem, DataItem>;

/// The MonitoredItems of a client, all in one Subscription of the server that is made for the
/// first of them, and the PublishRequests that feed it.
///
/// Several PublishRequests are kept with the server, so that it can publish at any time.
///
/// While the connection is lost they rest: interrupt(), then resume(). A session that was kept
/// still has its Subscription and the notifications of the time between; for a new session, all is
/// made anew.
///
/// Threading: the client's thread, but for newHandle().
class ClientSubscriptions {
public:
    using Added = std::function<void(Answer<>)>;
    /// State of a connection that came back.
    struct Return {
        bool session_kept = false;
        NamespaceMove move{};
    };

    explicit ClientSubscriptions(ClientCore& core) : core_(core) {}

    /// Names an item; any thread.
    std::uint32_t newHandle() noexcept { return ++last_handle_; }
    /// Adds an item; `added` gets the outcome while the stack is not at work.
    void add(std::uint32_t handle, ItemRequest request, Deadline deadline, Added added);
    /// Removes an item: from now on its callback does not run. Unknown handles are ignored.
    void remove(std::uint32_t handle);
    /// Notifies all items that nothing will come any more, each once.
    void end(StatusCode status);
    /// The connection is lost; all items are notified.
    void interrupt(StatusCode status);
    /// Continues over a new connection. `resumed` runs once, when every item was notified that it
    /// goes on or, with a reason, that it has ended; not if the connection is interrupted before.
    void resume(const Return& how, std::function<void()> resumed);

private:
    struct Item {
        ItemRequest request;
        Deadline deadline;            // for its creation
        Added added;                  // empty: was called
        std::uint32_t server_id = 0;  // 0: the server does not know it (any more)
        bool ended = false;
        bool renewing = false;  // is being made again
    };
    // Shared by the map and a callback that runs, which may remove its own item.
    using SharedItem = std::shared_ptr<Item>;

    void createSubscription(Deadline deadline);
    void subscriptionCreated(const Answer<UA_CreateSubscriptionResponse*>& answer);
    void createItem(std::uint32_t handle, const Item& item);
    void itemCreated(std::uint32_t handle, const Answer<UA_CreateMonitoredItemsResponse*>& answer);
    void deleteItem(std::uint32_t server_id);
    void settle(Item& item, Answer<> outcome);
    void endItem(std::uint32_t handle, Item& item, StatusCode status);

    // client_subscriptions_renewal.cpp
    void goOn();
    void renew(const NamespaceMove& move);
    void renewed(std::uint32_t handle, Item& item, const Answer<>& outcome);
    void oneRenewed();
    void finishResuming();
    void lostByServer(StatusCode status);
    void tellInterrupted(StatusCode status);

    void refill();
    void publish();
    void published(const Answer<UA_PublishResponse*>& answer);
    void publishFailed(const Failure& failure);
    void take(UA_NotificationMessage& message);
    void takeNotification(const UA_ExtensionObject& notification);
    void takeEvent(UA_EventFieldList& event);
    void checkSequence(const UA_NotificationMessage& message);
    void tell(std::uint32_t handle, EventNotice notice);
    void tell(std::uint32_t handle, DataValue value);
    template <typename Kind, typename News>
    void tellAs(std::uint32_t handle, News news);

    ClientCore& core_;
    std::atomic<std::uint32_t> last_handle_{0};
    std::map<std::uint32_t, SharedItem> items_;
    bool creating_ = false;
    std::uint32_t subscription_id_ = 0;  // 0: none
    std::uint32_t next_sequence_number_ = 1;
    std::uint32_t outstanding_ = 0;
    std::uint32_t wanted_ = 10;
    std::vector<std::uint32_t> unacknowledged_;
    std::vector<std::uint32_t> unwanted_;  // items of the server's to be deleted after a resume()
    bool resting_ = false;                 // nothing is sent
    bool interrupted_ = false;             // as the items were notified
    std::size_t renewing_ = 0;             // items that are being made again
    std::function<void()> resumed_;        // not empty: resume() is under way
};

}  // namespace metier::opcua
