// The MonitoredItem and Subscription services.
#include <array>

#include "filters.hpp"
#include "odd_values.hpp"
#include "requests.hpp"

namespace metier::hostile {

namespace {

constexpr std::uint32_t kEventNotifier = 12;

void writeParameters(Writer& writer, const Known& known) {
    writer.number(static_cast<std::uint32_t>(writer.random().next()));
    writer.real(100);
    writeFilter(writer, known);
    writer.number(static_cast<std::uint32_t>(writer.random().below(200)));
    writer.boolean(true);
}

std::size_t fewOrMany(Random& random) {
    return random.below(random.oneIn(60) ? 300 : 4);
}

void writeCreateItems(Writer& writer, const Known& known) {
    auto& random = writer.random();
    writer.number(anySubscription(random, known));
    writer.number(static_cast<std::uint32_t>(random.below(4)));
    const auto items = fewOrMany(random);
    writer.count(items);
    for (std::size_t i = 0; i < items; ++i) {
        const bool events = random.oneIn(2);
        writer.id(events ? anyNode(random, known) : anyVariable(random, known));
        writer.number(events ? kEventNotifier : kValueAttribute);
        writer.noText();
        writer.exactly(std::uint16_t{0});
        writer.noText();
        writer.number(static_cast<std::uint32_t>(random.below(3)));
        writeParameters(writer, known);
    }
}

void writeModifyItems(Writer& writer, const Known& known) {
    writer.number(anySubscription(writer.random(), known));
    writer.number(std::uint32_t{2});
    const auto items = fewOrMany(writer.random());
    writer.count(items);
    for (std::size_t i = 0; i < items; ++i) {
        writer.number(anyItem(writer.random(), known));
        writeParameters(writer, known);
    }
}

void writeItemIds(Writer& writer, const Known& known) {
    const auto items = fewOrMany(writer.random());
    writer.count(items);
    for (std::size_t i = 0; i < items; ++i) {
        writer.number(anyItem(writer.random(), known));
    }
}

void writeMonitoringMode(Writer& writer, const Known& known) {
    writer.number(anySubscription(writer.random(), known));
    writer.number(static_cast<std::uint32_t>(writer.random().below(4)));
    writeItemIds(writer, known);
}

void writeTriggering(Writer& writer, const Known& known) {
    writer.number(anySubscription(writer.random(), known));
    writer.number(anyItem(writer.random(), known));
    writeItemIds(writer, known);
    writeItemIds(writer, known);
}

void writeDeleteItems(Writer& writer, const Known& known) {
    writer.number(anySubscription(writer.random(), known));
    writeItemIds(writer, known);
}

void writeCreateSubscription(Writer& writer, const Known& /*known*/) {
    writer.real(50);
    writer.number(std::uint32_t{30});
    writer.number(std::uint32_t{10});
    writer.number(std::uint32_t{0});
    writer.boolean(true);
    writer.number(std::uint8_t{0});
}

void writeModifySubscription(Writer& writer, const Known& known) {
    writer.number(anySubscription(writer.random(), known));
    writer.real(20);
    writer.number(std::uint32_t{30});
    writer.number(std::uint32_t{10});
    writer.number(std::uint32_t{0});
    writer.number(std::uint8_t{0});
}

void writeSubscriptionIds(Writer& writer, const Known& known) {
    const auto subscriptions = writer.random().below(4);
    writer.count(subscriptions);
    for (std::size_t i = 0; i < subscriptions; ++i) {
        writer.number(anySubscription(writer.random(), known));
    }
}

void writePublishingMode(Writer& writer, const Known& known) {
    writer.boolean(writer.random().oneIn(2));
    writeSubscriptionIds(writer, known);
}

void writePublish(Writer& writer, const Known& known) {
    const auto acknowledged = writer.random().below(writer.random().oneIn(40) ? 500 : 3);
    writer.count(acknowledged);
    for (std::size_t i = 0; i < acknowledged; ++i) {
        writer.number(anySubscription(writer.random(), known));
        writer.number(static_cast<std::uint32_t>(writer.random().below(50)));
    }
}

void writeRepublish(Writer& writer, const Known& known) {
    writer.number(anySubscription(writer.random(), known));
    writer.number(static_cast<std::uint32_t>(writer.random().below(50)));
}

void writeTransfer(Writer& writer, const Known& known) {
    writeSubscriptionIds(writer, known);
    writer.boolean(writer.random().oneIn(2));
}

}  // namespace

std::span<const Request> subscriptionRequests() {
    static constexpr std::array<Request, 12> all{{{751, writeCreateItems, 8},
                                                  {763, writeModifyItems, 3},
                                                  {769, writeMonitoringMode, 2},
                                                  {775, writeTriggering, 2},
                                                  {781, writeDeleteItems, 3},
                                                  {787, writeCreateSubscription, 3},
                                                  {793, writeModifySubscription, 2},
                                                  {799, writePublishingMode, 2},
                                                  {826, writePublish, 10},
                                                  {832, writeRepublish, 3},
                                                  {841, writeTransfer, 3},
                                                  {847, writeSubscriptionIds, 3}}};
    return all;
}

}  // namespace metier::hostile
