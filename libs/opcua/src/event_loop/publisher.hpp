#pragma once

#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "event_loop.hpp"
#include "message_counter.hpp"
#include "timers.hpp"

namespace metier::opcua {

/// Finds the Subscriptions' publish callbacks among the stack's timers and runs them at once.
///
/// A publish callback with nothing to say advances its Subscription's keep-alive counter, one
/// without a queued PublishRequest its lifetime counter. So it is never run early without a queued
/// PublishRequest (requests received less responses sent, counted on the chunk headers), and after
/// it had nothing to say it rests, the longer the more often: 1 ms, doubling to 100 ms.
///
/// Threading: under the loop's mutex.
class Publisher {
public:
    /// \param during the accepted connection whose message is processed, or 0
    void timerAdded(const Timer& timer, ConnectionId during);
    void timerRemoved(TimerId id) { subscriptions_.erase(id); }
    /// Calls a due timer, and notes the connection to which its notifications go.
    void runTimer(const Timer& timer);

    void accepted(ConnectionId connection) { peers_[connection]; }
    void received(ConnectionId connection, std::span<const std::uint8_t> bytes);
    void sent(ConnectionId connection, std::span<const std::uint8_t> chunk);
    void closed(ConnectionId connection) { peers_.erase(connection); }

    void request(std::span<const ConnectionId> connections, SteadyTime now);
    /// Whether flush() may have something to do, and since when it was asked for.
    std::optional<SteadyTime> requestedAt() const { return requested_at_; }
    void flush(SteadyTime now);
    /// Time at which a resting Subscription may be published again.
    std::optional<SteadyTime> retryAt() const { return retry_at_; }

    std::uint64_t flushes() const { return flushes_; }
    std::uint64_t fruitless() const { return fruitless_; }
    /// Times from a request to its publication. Any thread.
    const TimeHistogram& latency() const { return latency_; }

private:
    struct Peer {
        MessageCounter incoming;
        long open_requests = 0;  ///< received and not answered: queued PublishRequests
    };
    struct Subscription {
        Timer publish;
        ConnectionId created_on = 0;
        ConnectionId connection = 0;  ///< connection to which its notifications went last
        bool wanted = false;
        unsigned fruitless_in_a_row = 0;
        SteadyTime rests_until{};
    };

    /// \return whether the callback sent something
    bool publish(const Timer& timer);
    bool canPublish(const Subscription& subscription, SteadyTime now);
    void publishNow(TimerId id, SteadyTime now, SteadyTime requested);

    UA_Callback publish_callback_ = nullptr;
    std::unordered_map<TimerId, Subscription> subscriptions_;
    std::unordered_map<ConnectionId, Peer> peers_;
    std::vector<TimerId> wanted_;
    std::optional<SteadyTime> requested_at_;
    std::optional<SteadyTime> retry_at_;
    bool publishing_ = false;
    ConnectionId sent_to_ = 0;  ///< connection used by the running publish callback
    std::uint64_t flushes_ = 0;
    std::uint64_t fruitless_ = 0;
    TimeHistogram latency_;
};

}  // namespace metier::opcua
