#include <algorithm>
#include <utility>

#include "rosbridge.hpp"
#include "rosbridge_json.hpp"

namespace metier::virtual_edo {
namespace {

/// Most messages that wait for one subscription.
constexpr std::int64_t kLongestQueue = 256;

template <typename Wishes, typename Member>
std::int64_t leastOf(const Wishes& wishes, Member member) {
    const auto least = std::min_element(
        wishes.begin(), wishes.end(),
        [&](const auto& a, const auto& b) { return a.second.*member < b.second.*member; });
    return least->second.*member;
}

}  // namespace

bool Rosbridge::hasSubscribers(std::string_view topic) const {
    return std::any_of(clients_.begin(), clients_.end(), [&](const auto& entry) {
        return entry.second.subscriptions.contains(topic);
    });
}

void Rosbridge::publish(const std::string& topic, const Json& message) {
    std::string text;
    for (auto& [id, client] : clients_) {
        const auto subscription = client.subscriptions.find(topic);
        if (subscription == client.subscriptions.end()) {
            continue;
        }
        if (text.empty()) {
            text = toText({{"topic", topic}, {"msg", message}, {"op", "publish"}});
        }
        deliver(client, subscription->second, text);
    }
}

std::chrono::milliseconds Rosbridge::Subscription::throttle() const {
    return std::chrono::milliseconds(leastOf(wishes, &SubscriptionWish::throttle_ms));
}

std::size_t Rosbridge::Subscription::queueLength() const {
    const auto least = leastOf(wishes, &SubscriptionWish::queue_length);
    return static_cast<std::size_t>(std::min(least, kLongestQueue));
}

void Rosbridge::deliver(Client& client, Subscription& subscription, const std::string& text) {
    const bool due =
        !subscription.last_sent || now_ - *subscription.last_sent >= subscription.throttle();
    if (due && subscription.queue.empty()) {
        subscription.last_sent = now_;
        send(client, text);
        return;
    }
    const std::size_t room = subscription.queueLength();
    if (room == 0) {
        return;
    }
    if (subscription.queue.size() >= room) {
        subscription.queue.pop_front();
    }
    subscription.queue.push_back(text);
}

void Rosbridge::setTime(SteadyTime now) {
    now_ = now;
    for (auto& [id, client] : clients_) {
        for (auto& [topic, subscription] : client.subscriptions) {
            auto& queue = subscription.queue;
            if (!queue.empty() && now_ - *subscription.last_sent >= subscription.throttle()) {
                subscription.last_sent = now_;
                send(client, queue.front());
                queue.pop_front();
            }
        }
    }
}

void Rosbridge::send(Client& client, const std::string& text) {
    if (!client.fragment_size || text.size() <= *client.fragment_size) {
        client.send(text);
        return;
    }
    const std::size_t total = (text.size() + *client.fragment_size - 1) / *client.fragment_size;
    Json fragment{{"op", "fragment"},
                  {"id", std::to_string(client.fragments_sent++)},
                  {"data", ""},
                  {"num", 0},
                  {"total", total}};
    for (std::size_t number = 0; number < total; ++number) {
        fragment["data"] = text.substr(number * *client.fragment_size, *client.fragment_size);
        fragment["num"] = number;
        client.send(toText(fragment));
    }
}

void Rosbridge::sendStatus(Client& client, const std::string& text, const Json& request) {
    if (client.level < 1) {
        return;
    }
    Json status{{"op", "status"}, {"level", "error"}, {"msg", text}};
    if (const std::string id = requestId(request); !id.empty()) {
        status["id"] = id;
    }
    send(client, toText(status));
}

}  // namespace metier::virtual_edo
