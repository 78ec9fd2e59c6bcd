#include "publisher.hpp"

#include <algorithm>
#include <utility>

namespace metier::opcua {

namespace {

constexpr std::chrono::milliseconds kLongestRest{100};
constexpr std::chrono::milliseconds kLongestFlush{2};  // then peers are read before it goes on
constexpr unsigned kDoublings = 7;                     // up to 128 ms, more than the longest

std::chrono::milliseconds restAfter(unsigned fruitless_in_a_row) {
    return std::min(kLongestRest,
                    std::chrono::milliseconds{1U << std::min(fruitless_in_a_row, kDoublings)});
}

}  // namespace

void Publisher::timerAdded(const Timer& timer, ConnectionId during) {
    if (timer.data == nullptr || timer.interval == std::chrono::nanoseconds::zero()) {
        return;
    }
    if (publish_callback_ == nullptr && during != 0) {
        publish_callback_ = timer.callback;
    }
    if (timer.callback == publish_callback_) {
        subscriptions_[timer.id] = {.publish = timer, .created_on = during, .connection = during};
    }
}

void Publisher::runTimer(const Timer& timer) {
    const auto found = subscriptions_.find(timer.id);
    if (found == subscriptions_.end()) {
        timer.callback(timer.application, timer.data);
        return;
    }
    found->second.wanted =
        false;  // this is the publishing, or the stack takes note that it is late
    publish(timer);
}

void Publisher::received(ConnectionId connection, std::span<const std::uint8_t> bytes) {
    const auto peer = peers_.find(connection);
    if (peer == peers_.end()) {
        return;
    }
    peer->second.open_requests += static_cast<long>(peer->second.incoming.feed(bytes));
    if (!wanted_.empty() && !requested_at_) {
        requested_at_ = std::chrono::steady_clock::now();
    }
}

void Publisher::sent(ConnectionId connection, std::span<const std::uint8_t> chunk) {
    const auto peer = peers_.find(connection);
    if (peer == peers_.end()) {
        return;
    }
    if (publishing_) {
        sent_to_ = connection;
    }
    const auto answers = static_cast<long>(MessageCounter().feed(chunk));
    peer->second.open_requests = std::max(0L, peer->second.open_requests - answers);
}

void Publisher::request(std::span<const ConnectionId> connections, SteadyTime now) {
    if (connections.empty()) {
        return;
    }
    std::vector<ConnectionId> sorted(connections.begin(), connections.end());
    std::sort(sorted.begin(), sorted.end());
    const auto asked_for = [&](ConnectionId id) {
        return std::binary_search(sorted.begin(), sorted.end(), id);
    };
    for (auto& [id, subscription] : subscriptions_) {
        if (!subscription.wanted &&
            (asked_for(subscription.connection) || asked_for(subscription.created_on))) {
            subscription.wanted = true;
            wanted_.push_back(id);
        }
    }
    if (!wanted_.empty() && !requested_at_) {
        requested_at_ = now;
    }
}

void Publisher::flush(SteadyTime now) {
    const auto requested = std::exchange(requested_at_, std::nullopt).value_or(now);
    retry_at_.reset();
    const auto end = now + kLongestFlush;
    const auto wanted = std::exchange(wanted_, {});
    for (auto next = wanted.begin(); next != wanted.end(); ++next) {
        const auto found = subscriptions_.find(*next);
        if (found == subscriptions_.end() || !found->second.wanted) {
            continue;
        }
        if (!canPublish(found->second, now)) {
            wanted_.push_back(*next);
            continue;
        }
        publishNow(*next, now, requested);
        if (std::chrono::steady_clock::now() >= end && next + 1 != wanted.end()) {
            wanted_.insert(wanted_.begin(), next + 1, wanted.end());
            requested_at_ = requested;
            return;
        }
    }
}

bool Publisher::canPublish(const Subscription& subscription, SteadyTime now) {
    const auto peer = peers_.find(subscription.connection);
    if (peer == peers_.end() || peer->second.open_requests == 0) {
        return false;  // tried again when a message arrives
    }
    if (now < subscription.rests_until) {
        retry_at_ = std::min(retry_at_.value_or(SteadyTime::max()), subscription.rests_until);
        return false;
    }
    return true;
}

void Publisher::publishNow(TimerId id, SteadyTime now, SteadyTime requested) {
    const Timer timer = subscriptions_.at(id).publish;
    ++flushes_;
    const bool fruitful = publish(timer);
    if (fruitful) {
        const std::chrono::duration<double> took = std::chrono::steady_clock::now() - requested;
        latency_.add(took.count());
    } else {
        ++fruitless_;
    }
    const auto found = subscriptions_.find(id);
    if (found == subscriptions_.end()) {
        return;  // deleted by its own callback
    }
    auto& subscription = found->second;
    subscription.wanted = false;
    if (!fruitful) {
        subscription.rests_until = now + restAfter(subscription.fruitless_in_a_row++);
    }
}

bool Publisher::publish(const Timer& timer) {
    publishing_ = true;
    sent_to_ = 0;
    timer.callback(timer.application, timer.data);
    publishing_ = false;
    const auto found = subscriptions_.find(timer.id);
    if (found != subscriptions_.end() && sent_to_ != 0) {
        found->second.connection = sent_to_;
        found->second.fruitless_in_a_row = 0;
    }
    return sent_to_ != 0;
}

}  // namespace metier::opcua
