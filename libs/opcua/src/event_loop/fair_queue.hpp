#pragma once

#include <array>
#include <chrono>
#include <compare>
#include <cstdint>
#include <optional>
#include <set>
#include <unordered_map>

#include "event_loop.hpp"

namespace metier::opcua {

/// Knowledge about the peer of a connection.
enum class Standing {
    stranger,  ///< nothing
    known,     ///< it showed a certificate that is trusted
    member,    ///< it has a Session
};

/// Order in which connections with waiting data are served. A connection may have to wait for 200
/// times the recent cost of its own turns; the one whose wait is over first is served first. So a
/// connection with cheap messages waits at most for one turn of an expensive one, and none waits
/// for ever. Strangers and admitted peers share the thread evenly.
///
/// Threading: under the loop's mutex.
class FairQueue {
public:
    using Cost = std::chrono::nanoseconds;

    /// The connection waits for its turn; nothing if it does already.
    void ready(ConnectionId connection, Standing standing, SteadyTime now);
    /// Connection to serve next; it is taken out of the order. Nothing if none waits.
    std::optional<ConnectionId> next();
    /// Cost of the turn of the connection that next() returned last.
    void used(Cost cost);
    void forget(ConnectionId connection);
    bool empty() const { return lines_[0].waiting.empty() && lines_[1].waiting.empty(); }

private:
    struct Place {
        SteadyTime due{};
        std::uint64_t since{};  ///< as a count of all who waited
        ConnectionId connection{};
        auto operator<=>(const Place&) const = default;
    };
    struct Line {
        std::set<Place> waiting;
        Cost used{};  ///< total of its turns
    };
    struct Account {
        Cost turn{};  ///< cost of one turn
        std::size_t line = 0;
        std::optional<Place> place{};
    };

    std::array<Line, 2> lines_;  // strangers, and the others
    std::unordered_map<ConnectionId, Account> accounts_;
    Cost clock_{};  ///< of the line that was served last
    std::uint64_t count_ = 0;
    ConnectionId served_ = 0;
    std::size_t served_line_ = 0;
};

}  // namespace metier::opcua
