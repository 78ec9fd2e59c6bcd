#include "client/client_subscriptions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <utility>

#include "client/client_core.hpp"
#include "common/convert.hpp"

namespace metier::opcua {

namespace {

constexpr std::uint32_t kKeepAlives = 10;    // [publishing intervals] of silence
constexpr std::uint32_t kLeastLifetime = 3;  // times the keep-alive, as the standard asks
constexpr StatusCode kNoSubscription{UA_STATUSCODE_BADNOSUBSCRIPTION};
constexpr UA_NodeId kOverflow{0, UA_NODEIDTYPE_NUMERIC, {UA_NS0ID_EVENTQUEUEOVERFLOWEVENTTYPE}};

const NodeId& nodeOf(const ItemRequest& request) {
    return std::visit([](const auto& item) -> const NodeId& { return item.node; }, request);
}

std::string doingTo(const ItemRequest& request) {
    return "subscribing to " + nodeOf(request).toString();
}

template <typename Element>
std::span<Element> all(Element* first, std::size_t count) {
    return {first, count};
}

/// Whether an event only reports that others were lost; it may have fewer fields than requested.
bool isOverflow(const UA_EventFieldList& event) {
    const auto fields = all(event.eventFields, event.eventFieldsSize);
    return std::any_of(fields.begin(), fields.end(), [](const UA_Variant& field) {
        return UA_Variant_hasScalarType(&field, &UA_TYPES[UA_TYPES_NODEID]) &&
               UA_NodeId_equal(static_cast<const UA_NodeId*>(field.data), &kOverflow);
    });
}

/// The first field of an EventFilter that the server rejects, `, field 0:Time`; empty if none.
std::string rejectedField(const ItemRequest& request, const UA_MonitoredItemCreateResult& result) {
    const auto* asked = std::get_if<EventItem>(&request);
    const auto* filter =
        decodedAs<UA_EventFilterResult>(result.filterResult, UA_TYPES[UA_TYPES_EVENTFILTERRESULT]);
    if (asked == nullptr || filter == nullptr) {
        return {};
    }
    const auto& fields = asked->filter.fields;
    const auto count = std::min(fields.size(), filter->selectClauseResultsSize);
    for (std::size_t i = 0; i < count; ++i) {
        if (StatusCode(filter->selectClauseResults[i]).isBad()) {
            return ", field " + textOf(fields[i]);
        }
    }
    return {};
}

Answer<> createdAs(const ItemRequest& request, const UA_MonitoredItemCreateResult& result) {
    const StatusCode status(result.statusCode);
    return status.isBad() ? failed(status, doingTo(request) + rejectedField(request, result))
                          : Answer<>();
}

/// Whether a field is an array of no length, by which our servers and others say that it is absent.
bool isNullArray(const UA_Variant& field) noexcept {
    return field.type != nullptr && field.data == nullptr;
}

/// The stack's form of an EventFilter; a view of it, as long as both live and do not move.
class NativeEventFilter {
public:
    explicit NativeEventFilter(const EventFilter& filter) {
        paths_.reserve(filter.fields.size());
        for (const auto& field : filter.fields) {
            auto& path = paths_.emplace_back();
            for (const auto& name : field) {
                path.push_back(viewOf(name));
            }
            fields_.push_back({viewOf(ids::kBaseEventType), path.size(), path.data(),
                               UA_ATTRIBUTEID_VALUE, UA_STRING_NULL});
        }
        native_.selectClausesSize = fields_.size();
        native_.selectClauses = fields_.data();
        if (filter.of_type) {
            ofType(*filter.of_type);
        }
    }
    NativeEventFilter(const NativeEventFilter&) = delete;
    NativeEventFilter& operator=(const NativeEventFilter&) = delete;

    UA_EventFilter* get() noexcept { return &native_; }

private:
    void ofType(const NodeId& type) {
        type_ = viewOf(type);
        UA_Variant_setScalar(&operand_.value, &type_, &UA_TYPES[UA_TYPES_NODEID]);
        UA_ExtensionObject_setValueNoDelete(&operand_object_, &operand_,
                                            &UA_TYPES[UA_TYPES_LITERALOPERAND]);
        element_ = {UA_FILTEROPERATOR_OFTYPE, 1, &operand_object_};
        native_.whereClause = {1, &element_};
    }

    std::vector<std::vector<UA_QualifiedName>> paths_;
    std::vector<UA_SimpleAttributeOperand> fields_;
    UA_NodeId type_{};
    UA_LiteralOperand operand_{};
    UA_ExtensionObject operand_object_{};
    UA_ContentFilterElement element_{};
    UA_EventFilter native_{};
};

/// The stack's request for one item; a view of the item, as long as neither moves.
class NativeItem {
public:
    NativeItem(std::uint32_t handle, const ItemRequest& request) {
        native_.itemToMonitor.nodeId = viewOf(nodeOf(request));
        native_.monitoringMode = UA_MONITORINGMODE_REPORTING;
        native_.requestedParameters.clientHandle = handle;
        native_.requestedParameters.discardOldest = true;
        std::visit([this](const auto& item) { fill(item); }, request);
    }
    NativeItem(const NativeItem&) = delete;
    NativeItem& operator=(const NativeItem&) = delete;

    UA_MonitoredItemCreateRequest* get() noexcept { return &native_; }

private:
    void fill(const EventItem& item) {
        filter_.emplace(item.filter);
        native_.itemToMonitor.attributeId = UA_ATTRIBUTEID_EVENTNOTIFIER;
        native_.requestedParameters.queueSize = item.filter.queue_size;
        UA_ExtensionObject_setValueNoDelete(&native_.requestedParameters.filter, filter_->get(),
                                            &UA_TYPES[UA_TYPES_EVENTFILTER]);
    }
    void fill(const DataItem& item) {
        native_.itemToMonitor.attributeId = UA_ATTRIBUTEID_VALUE;
        native_.requestedParameters.queueSize = item.filter.queue_size;
        native_.requestedParameters.samplingInterval =
            static_cast<double>(item.filter.sampling_interval.count());
    }

    std::optional<NativeEventFilter> filter_;
    UA_MonitoredItemCreateRequest native_{};
};

}  // namespace

void ClientSubscriptions::add(std::uint32_t handle, ItemRequest request, Deadline deadline,
                              Added added) {
    auto item = std::make_shared<Item>();
    item->request = std::move(request);
    item->deadline = deadline;
    item->added = std::move(added);
    items_.emplace(handle, item);
    if (subscription_id_ != 0) {
        createItem(handle, *item);
    } else if (!creating_) {
        createSubscription(deadline);
    }
}

void ClientSubscriptions::remove(std::uint32_t handle) {
    const auto found = items_.find(handle);
    if (found == items_.end()) {
        return;
    }
    const auto item = std::move(found->second);
    items_.erase(found);
    if (item->server_id != 0) {
        deleteItem(item->server_id);
    }
    if (item->renewing) {
        oneRenewed();
    }
}

void ClientSubscriptions::end(StatusCode status) {
    subscription_id_ = 0;
    unacknowledged_.clear();
    for (const auto& [handle, item] : items_) {
        if (!item->added) {
            endItem(handle, *item, status);
        }
    }
}

void ClientSubscriptions::endItem(std::uint32_t handle, Item& item, StatusCode status) {
    item.server_id = 0;
    if (!std::exchange(item.ended, true)) {
        tell(handle, EventNotice{EventNotice::Kind::ended, {}, status});
        tell(handle, DataValue{{}, status, {}, {}});
    }
}

void ClientSubscriptions::createSubscription(Deadline deadline) {
    creating_ = true;
    const auto interval = core_.options().publishing_interval;
    const auto lifetime = core_.options().session_timeout / interval;
    UA_CreateSubscriptionRequest request{};
    request.requestedPublishingInterval = static_cast<double>(interval.count());
    request.requestedMaxKeepAliveCount = kKeepAlives;
    request.requestedLifetimeCount =
        std::max(static_cast<std::uint32_t>(lifetime), kKeepAlives * kLeastLifetime);
    request.publishingEnabled = true;
    core_.send(request, {"creating a Subscription", deadline},
               [this](auto answer) { subscriptionCreated(answer); });
}

void ClientSubscriptions::subscriptionCreated(
    const Answer<UA_CreateSubscriptionResponse*>& answer) {
    creating_ = false;
    if (answer) {
        subscription_id_ = (*answer)->subscriptionId;
        next_sequence_number_ = 1;
        refill();
    }
    for (const auto& [handle, item] : items_) {
        if (!item->added && !item->renewing) {
            continue;
        }
        if (answer) {
            createItem(handle, *item);
        } else if (item->renewing) {
            renewed(handle, *item, tl::unexpected(answer.error()));
        } else {
            settle(*item, tl::unexpected(answer.error()));
        }
    }
}

void ClientSubscriptions::createItem(std::uint32_t handle, const Item& item) {
    NativeItem native(handle, item.request);
    UA_CreateMonitoredItemsRequest request{};
    request.subscriptionId = subscription_id_;
    request.timestampsToReturn = UA_TIMESTAMPSTORETURN_BOTH;
    request.itemsToCreateSize = 1;
    request.itemsToCreate = native.get();
    core_.send(request, {doingTo(item.request), item.deadline},
               [this, handle](auto answer) { itemCreated(handle, answer); });
}

void ClientSubscriptions::itemCreated(std::uint32_t handle,
                                      const Answer<UA_CreateMonitoredItemsResponse*>& answer) {
    const auto found = items_.find(handle);
    const auto item = found == items_.end() ? nullptr : found->second;
    const auto* result = answer && (*answer)->resultsSize == 1 ? &(*answer)->results[0] : nullptr;
    if (!item) {  // it was removed meanwhile
        if (result != nullptr && !StatusCode(result->statusCode).isBad()) {
            deleteItem(result->monitoredItemId);
        }
        return;
    }
    Answer<> outcome = answer ? failed(status::kBadUnexpectedError, doingTo(item->request))
                              : Answer<>(tl::unexpected(answer.error()));
    if (result != nullptr) {
        item->server_id = result->monitoredItemId;  // 0 if it was refused
        outcome = createdAs(item->request, *result);
    }
    if (item->renewing) {
        renewed(handle, *item, outcome);
    } else {
        settle(*item, std::move(outcome));
    }
}

void ClientSubscriptions::deleteItem(std::uint32_t server_id) {
    if (resting_) {
        unwanted_.push_back(server_id);
        return;
    }
    UA_DeleteMonitoredItemsRequest request{};
    request.subscriptionId = subscription_id_;
    request.monitoredItemIdsSize = 1;
    request.monitoredItemIds = &server_id;
    core_.send(request, {"ending a MonitoredItem", core_.deadline({})}, [](auto) {});
}

void ClientSubscriptions::settle(Item& item, Answer<> outcome) {
    if (auto added = std::exchange(item.added, nullptr)) {
        core_.later([added = std::move(added), outcome = std::move(outcome)] { added(outcome); });
    }
}

void ClientSubscriptions::refill() {
    while (!resting_ && subscription_id_ != 0 && outstanding_ < wanted_) {
        const auto before = outstanding_;
        publish();
        if (outstanding_ <= before) {
            return;  // it was refused at once: the connection is going
        }
    }
}

void ClientSubscriptions::publish() {
    std::vector<UA_SubscriptionAcknowledgement> acknowledged;
    for (const auto number : std::exchange(unacknowledged_, {})) {
        acknowledged.push_back({subscription_id_, number});
    }
    UA_PublishRequest request{};
    request.subscriptionAcknowledgementsSize = acknowledged.size();
    request.subscriptionAcknowledgements = acknowledged.data();
    ++outstanding_;
    core_.send(request, {"receiving notifications", {}},
               [this](auto answer) { published(answer); });
}

void ClientSubscriptions::published(const Answer<UA_PublishResponse*>& answer) {
    --outstanding_;
    if (!answer) {
        return publishFailed(answer.error());
    }
    if ((*answer)->subscriptionId == subscription_id_) {
        take((*answer)->notificationMessage);
    }
    refill();
}

void ClientSubscriptions::publishFailed(const Failure& failure) {
    if (failure.code == Errc::connection_lost || (core_.reconnects() && resting_)) {
        return;  // the loss of the connection is or will be notified
    }
    if (failure.status == status::kBadTimeout) {  // the server let it run out unused
        return refill();
    }
    if (outstanding_ == 0 || failure.status == kNoSubscription) {
        return subscription_id_ == 0 ? void() : lostByServer(failure.status);
    }
    wanted_ = outstanding_;  // the server takes no more of them
}

void ClientSubscriptions::take(UA_NotificationMessage& message) {
    checkSequence(message);
    for (const auto& notification : all(message.notificationData, message.notificationDataSize)) {
        takeNotification(notification);
    }
}

void ClientSubscriptions::checkSequence(const UA_NotificationMessage& message) {
    if (message.sequenceNumber != next_sequence_number_) {
        for (const auto& [handle, item] : items_) {
            tell(handle, EventNotice{EventNotice::Kind::overflow, {}, {}});
        }
    }
    next_sequence_number_ = message.sequenceNumber;
    if (message.notificationDataSize == 0) {
        return;  // a keep-alive announces the next number and uses none
    }
    unacknowledged_.push_back(message.sequenceNumber);
    next_sequence_number_ = std::max(message.sequenceNumber + 1, 1U);  // 0 is skipped
}

void ClientSubscriptions::takeNotification(const UA_ExtensionObject& notification) {
    if (const auto* events = decodedAs<UA_EventNotificationList>(
            notification, UA_TYPES[UA_TYPES_EVENTNOTIFICATIONLIST])) {
        for (auto& event : all(events->events, events->eventsSize)) {
            takeEvent(event);
        }
    } else if (const auto* changes = decodedAs<UA_DataChangeNotification>(
                   notification, UA_TYPES[UA_TYPES_DATACHANGENOTIFICATION])) {
        for (const auto& change : all(changes->monitoredItems, changes->monitoredItemsSize)) {
            tell(change.clientHandle, fromNative(change.value));
        }
    } else if (const auto* ended = decodedAs<UA_StatusChangeNotification>(
                   notification, UA_TYPES[UA_TYPES_STATUSCHANGENOTIFICATION])) {
        if (StatusCode(ended->status).isBad()) {
            lostByServer(StatusCode(ended->status));
        }
    }
}

void ClientSubscriptions::takeEvent(UA_EventFieldList& event) {
    const auto found = items_.find(event.clientHandle);
    const auto* item =
        found == items_.end() ? nullptr : std::get_if<EventItem>(&found->second->request);
    if (item == nullptr) {
        return;
    }
    EventNotice notice;
    if (isOverflow(event)) {
        notice.kind = EventNotice::Kind::overflow;
    } else {
        for (auto& field : all(event.eventFields, event.eventFieldsSize)) {
            notice.fields.push_back(isNullArray(field) ? Value() : ValueAccess::take(field));
        }
        notice.fields.resize(item->filter.fields.size());  // a strange server may send others
    }
    tell(event.clientHandle, std::move(notice));
}

void ClientSubscriptions::tell(std::uint32_t handle, EventNotice notice) {
    tellAs<EventItem>(handle, std::move(notice));
}

void ClientSubscriptions::tell(std::uint32_t handle, DataValue value) {
    tellAs<DataItem>(handle, std::move(value));
}

/// Gives the news to the item's callback, if the item is of that kind and was not removed
/// meanwhile.
template <typename Kind, typename News>
void ClientSubscriptions::tellAs(std::uint32_t handle, News news) {
    core_.later([this, handle, news = std::move(news)] {
        const auto found = items_.find(handle);
        const auto item = found == items_.end() ? nullptr : found->second;
        if (const auto* wanted = item ? std::get_if<Kind>(&item->request) : nullptr) {
            wanted->callback(news);
        }
    });
}

}  // namespace metier::opcua
