#include "requests.hpp"

#include <cstring>

namespace metier::system_tests {
namespace {

constexpr std::uint16_t kServerObject = 2253;
constexpr std::uint16_t kServerStatus = 2256;
constexpr std::uint16_t kCurrentTime = 2258;
constexpr std::uint16_t kBaseDataVariableType = 63;
constexpr std::uint16_t kBaseEventType = 2041;
constexpr std::uint16_t kEventFilter = 727;
constexpr std::uint32_t kValue = 13;
constexpr std::uint32_t kEventNotifier = 12;
constexpr std::uint32_t kReporting = 2;

void putReadValueId(WireBytes& body, std::uint16_t node, std::uint32_t attribute) {
    body.node(node).put(attribute).nothing().put(std::uint16_t{0}).nothing();
}

/// \param classes that targets may have, a mask; 0: all
WireBytes browse(std::size_t nodes, std::uint16_t node, std::uint32_t classes) {
    constexpr std::uint32_t kBothWays = 2;
    constexpr std::uint32_t kEveryField = 63;
    WireBytes body;
    body.node(0).put(std::int64_t{0}).put(std::uint32_t{0}).put(std::uint32_t{0});
    body.put(static_cast<std::int32_t>(nodes));
    for (std::size_t i = 0; i < nodes; ++i) {
        body.node(node).put(kBothWays).node(0).put(std::uint8_t{1});
        body.put(classes).put(kEveryField);
    }
    return body;
}

/// EventType and Message of whatever happens.
WireBytes eventFilter() {
    WireBytes filter;
    filter.put(std::int32_t{2});
    for (const std::string_view field : {"EventType", "Message"}) {
        filter.node(kBaseEventType).put(std::int32_t{1}).put(std::uint16_t{0}).text(field);
        filter.put(kValue).nothing();
    }
    return filter.nothing();
}

template <typename Number>
Number valueAt(const std::string& answer, std::size_t place) {
    Number number{};
    if (place + sizeof(number) <= answer.size()) {
        std::memcpy(&number, answer.data() + place, sizeof(number));
    }
    return number;
}

}  // namespace

WireBytes browseOf(std::size_t nodes) {
    return browse(nodes, kServerObject, 0);
}

WireBytes costlyBrowseOf(std::size_t nodes) {
    constexpr std::uint32_t kViews = 128;
    return browse(nodes, kBaseDataVariableType, kViews);
}

WireBytes readOf(std::size_t nodes) {
    WireBytes body;
    body.put(0.0).put(std::uint32_t{0}).put(static_cast<std::int32_t>(nodes));
    for (std::size_t i = 0; i < nodes; ++i) {
        putReadValueId(body, kServerStatus, kValue);
    }
    return body;
}

WireBytes writeOf(std::size_t nodes) {
    WireBytes body;
    body.put(static_cast<std::int32_t>(nodes));
    for (std::size_t i = 0; i < nodes; ++i) {
        body.node(kCurrentTime).put(kValue).nothing();
        body.put(std::uint8_t{1}).put(std::uint8_t{1}).put(std::uint8_t{0});  // false, alone
    }
    return body;
}

WireBytes publish() {
    return WireBytes().nothing();
}

WireBytes subscriptionOf(const Subscribing& subscribing) {
    constexpr std::uint32_t kKeepAlives = 10;
    WireBytes body;
    body.put(subscribing.interval_ms).put(subscribing.lifetime_count).put(kKeepAlives);
    return body.put(std::uint32_t{0}).put(std::uint8_t{1}).put(std::uint8_t{0});
}

WireBytes itemsOf(std::uint32_t subscription, const Items& items) {
    WireBytes body;
    body.put(subscription).put(std::uint32_t{2}).put(static_cast<std::int32_t>(items.count));
    for (std::size_t i = 0; i < items.count; ++i) {
        putReadValueId(body, items.events ? kServerObject : kCurrentTime,
                       items.events ? kEventNotifier : kValue);
        body.put(kReporting).put(static_cast<std::uint32_t>(i)).put(0.0);
        if (items.events) {
            body.node(kEventFilter).put(std::uint8_t{1}).text(eventFilter().str());
        } else {
            body.put(std::uint16_t{0}).put(std::uint8_t{0});
        }
        body.put(items.queue).put(std::uint8_t{1});
    }
    return body;
}

WireBytes callOf(const Calling& calling) {
    WireBytes body;
    body.put(static_cast<std::int32_t>(calling.count));
    for (std::size_t i = 0; i < calling.count; ++i) {
        body.node(calling.name_space, calling.skill);
        body.node(calling.name_space, calling.skill + "/" + calling.method).nothing();
    }
    return body;
}

std::optional<std::uint32_t> subscribe(RawPeer& peer) {
    const auto answer = peer.ask(request::kCreateSubscription, subscriptionOf({}));
    return answer ? std::optional(numberAt(*answer, 0)) : std::nullopt;
}

std::uint32_t numberAt(const std::string& answer, std::size_t place) {
    return valueAt<std::uint32_t>(answer, place);
}

double doubleAt(const std::string& answer, std::size_t place) {
    return valueAt<double>(answer, place);
}

}  // namespace metier::system_tests
