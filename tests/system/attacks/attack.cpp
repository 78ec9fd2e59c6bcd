#include "attack.hpp"

#include <fmt/format.h>
#include <poll.h>

#include <cstdio>
#include <functional>
#include <optional>
#include <utility>

#include "raw_peer.hpp"
#include "requests.hpp"

namespace metier::system_tests {
namespace {

using std::chrono::steady_clock;

constexpr int kSmallWindow = 4096;  // [byte] of a peer that does not mean to read
constexpr std::size_t kMostConnections = 1000;
constexpr std::size_t kMostNodes = 1000;  // in one request

/// One attack, from its begin to its end.
class Raid {
public:
    Raid(const AttackOrder& order, const std::function<bool()>& stop)
        : order_(order), stop_(stop), end_(steady_clock::now() + order.time) {}

    AttackCount run() {
        switch (order_.attack) {
            case Attack::deaf:
                askWithoutReading();
                break;
            case Attack::subscriber:
                subscribeOnce();
                break;
            case Attack::item_bomb:
                bomb();
                break;
            case Attack::chunks:
                flood();
                break;
            case Attack::sessions:
                crowd();
                break;
            case Attack::events:
                agitate();
                break;
            case Attack::requests:
                askFlatOut();
                break;
            case Attack::costly:
                askForTheMostExpensive();
                break;
            case Attack::half_open:
                knock();
                break;
        }
        return count_;
    }

private:
    bool goesOn() const { return !stop_() && steady_clock::now() < end_; }
    void inFullSwing() {
        if (!std::exchange(told_, true)) {
            fmt::print("{}\n", kAttacking);
            std::fflush(stdout);
        }
    }
    /// Waits until the server sends something, at most so long.
    static void rest(std::chrono::milliseconds time) {
        ::poll(nullptr, 0, static_cast<int>(time.count()));
    }

    RawPeer knockAs(bool (RawPeer::*far)(), int receive_buffer = 0) {
        RawPeer peer(order_.host, order_.port, receive_buffer);
        ++count_.connections;
        if (!peer.connected() || !(peer.*far)()) {
            ++count_.refused;
        }
        return peer;
    }
    /// So many sessions as the server gives, at most `most`.
    std::vector<RawPeer> sessions(std::size_t most, int receive_buffer = 0) {
        std::vector<RawPeer> peers;
        while (goesOn() && peers.size() < most) {
            auto peer = knockAs(&RawPeer::logIn, receive_buffer);
            if (!peer.connected() || count_.refused > 0) {
                break;
            }
            peers.push_back(std::move(peer));
        }
        return peers;
    }
    bool request(RawPeer& peer, std::uint16_t type, const WireBytes& body) {
        ++count_.requests;
        return peer.request(type, body);
    }

    void askWithoutReading() {
        constexpr std::size_t kPeers = 8;
        const auto much = browseOf(kMostNodes);
        auto peers = sessions(kPeers, kSmallWindow);
        while (goesOn()) {
            for (auto& peer : peers) {
                if (!peer.connected() || !request(peer, request::kBrowse, much)) {
                    ++count_.cut;
                    peer = knockAs(&RawPeer::logIn, kSmallWindow);
                }
            }
            inFullSwing();
        }
    }

    void subscribeOnce() {
        constexpr std::size_t kItems = 100;
        constexpr int kPublishes = 200;
        auto peer = knockAs(&RawPeer::logIn);
        const auto subscription = subscribe(peer);
        if (!subscription ||
            !peer.ask(request::kCreateMonitoredItems, itemsOf(*subscription, {.count = kItems}))) {
            ++count_.refused;
            return;
        }
        for (int i = 0; i < kPublishes; ++i) {
            request(peer, request::kPublish, publish());
        }
        inFullSwing();
        while (goesOn() && peer.drain()) {
            request(peer, request::kPublish, publish());
            rest(std::chrono::milliseconds(1));
        }
    }

    void bomb() {
        constexpr std::size_t kPerSubscription = 1000;
        constexpr std::size_t kSubscriptions = 20;  // more than one session gets
        constexpr int kPublishes = 20;
        auto peers = sessions(1);
        for (std::size_t i = 0; goesOn() && !peers.empty() && i < kSubscriptions; ++i) {
            const auto id = subscribe(peers[0]);
            const auto items = itemsOf(id.value_or(0), {.count = kPerSubscription});
            if (!id || !request(peers[0], request::kCreateMonitoredItems, items)) {
                ++count_.refused;
            }
        }
        for (int i = 0; !peers.empty() && i < kPublishes; ++i) {
            request(peers[0], request::kPublish, publish());
        }
        inFullSwing();
        while (goesOn() && !peers.empty() && peers[0].drain()) {
            request(peers[0], request::kPublish, publish());
            rest(std::chrono::milliseconds(1));
        }
    }

    void flood() {
        constexpr std::size_t kConnections = 200;  // more than the server takes
        std::vector<RawPeer> peers;
        while (goesOn()) {
            if (peers.size() < kConnections) {
                peers.push_back(knockAs(&RawPeer::hello));
                peers.back().openChannel();
            }
            for (auto& peer : peers) {
                ++count_.requests;
                if (!peer.connected() || !peer.intermediateChunk(65'000)) {
                    ++count_.cut;
                    peer = knockAs(&RawPeer::hello);
                    peer.openChannel();
                }
            }
            inFullSwing();
        }
    }

    void crowd() {
        auto peers = sessions(kMostConnections);
        inFullSwing();
        while (goesOn()) {
            auto one_more = knockAs(&RawPeer::logIn);
            for (auto& peer : peers) {
                peer.drain();
            }
        }
    }

    void agitate() {
        constexpr std::size_t kReaders = 8;
        constexpr std::uint64_t kLate = 64;  // rounds
        auto readers = sessions(kReaders, kSmallWindow);
        for (auto& reader : readers) {
            const auto id = subscribe(reader);
            if (!id ||
                !reader.ask(request::kCreateMonitoredItems, itemsOf(*id, {.events = true}))) {
                ++count_.refused;
            }
            for (int i = 0; i < 10; ++i) {
                request(reader, request::kPublish, publish());
            }
        }
        auto agitators = sessions(order_.skills.size());
        inFullSwing();
        for (std::uint64_t round = 1; goesOn() && !agitators.empty(); ++round) {
            for (std::size_t i = 0; i < agitators.size(); ++i) {
                for (const auto* method : {"Start", "Halt", "Reset"}) {
                    request(agitators[i], request::kCall,
                            callOf({order_.name_space, order_.skills[i], method}));
                }
                agitators[i].drain();
            }
            for (auto& reader : readers) {  // it reads, but late
                if (reader.connected() && round % kLate == 0) {
                    reader.drain();
                    request(reader, request::kPublish, publish());
                }
            }
        }
    }

    void askFlatOut() {
        constexpr std::size_t kPeers = 40;
        const auto much = readOf(kMostNodes);
        const auto little = readOf(1);
        auto peers = sessions(kPeers);
        inFullSwing();
        while (goesOn() && !peers.empty()) {
            for (auto& peer : peers) {
                if (peer.connected()) {
                    request(peer, request::kRead, count_.requests % 16 == 0 ? much : little);
                    peer.drain();
                }
            }
        }
    }

    void askForTheMostExpensive() {
        constexpr std::size_t kPeers = 4;
        const auto costly = costlyBrowseOf(kMostNodes);
        auto peers = sessions(kPeers);
        inFullSwing();
        while (goesOn() && !peers.empty()) {
            for (auto& peer : peers) {
                if (peer.connected()) {
                    request(peer, request::kBrowse, costly);
                    peer.drain();
                }
            }
        }
    }

    /// Attempts, a fifth each: nothing, a Hello, a channel, a session that is refused, an unknown
    /// user.
    void knock() {
        constexpr std::size_t kKept = 300;
        std::vector<RawPeer> peers;
        std::size_t next = 0;
        while (goesOn()) {
            RawPeer peer(order_.host, order_.port);
            ++count_.connections;
            const auto kind = count_.connections % 5;
            const bool taken =
                peer.connected() &&
                (kind == 0 || (kind == 4 && peer.send(order_.stranger)) ||
                 (kind < 4 && peer.hello() &&
                  (kind == 1 || (peer.openChannel() && (kind == 2 || peer.createSession())))));
            count_.refused += taken ? 0 : 1;
            if (peers.size() < kKept) {
                peers.push_back(std::move(peer));
            } else {
                inFullSwing();
                peers[next++ % kKept] = std::move(peer);
            }
        }
    }

    const AttackOrder& order_;
    const std::function<bool()>& stop_;
    const SteadyTime end_;
    AttackCount count_;
    bool told_ = false;
};

}  // namespace

AttackCount carryOut(const AttackOrder& order, const std::function<bool()>& stop) {
    return Raid(order, stop).run();
}

}  // namespace metier::system_tests
