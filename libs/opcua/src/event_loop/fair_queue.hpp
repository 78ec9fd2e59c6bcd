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

/// What is known of the peer of a connection.
enum class Standing {
    stranger,  ///< nothing
    known,     ///< it showed a certificate that is trusted
    member,    ///< it has a Session
};

/// Whose turn it is among connections that have something to be read. Each may have to wait for 200
/// times what its own turns cost, of late; whose time is up soonest comes first. So one whose
/// messages cost little waits for no more than the turn of one whose cost much, and nobody waits
/// for ever. Strangers and the others share the thread evenly.
///
/// Threading: under the loop's mutex.
class FairQueue {
public:
    using Cost = std::chrono::nanoseconds;

    /// The connection waits for its turn; nothing if it does already.
    void ready(ConnectionId connection, Standing standing, SteadyTime now);
    /// Whose turn it is; it waits no longer. Nothing if nobody waits.
    std::optional<ConnectionId> next();
    /// What the turn of the connection that next() gave last has cost.
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
        Cost used{};  ///< by all of it
    };
    struct Account {
        Cost turn{};  ///< what one costs
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
