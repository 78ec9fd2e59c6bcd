#pragma once

#include <optional>
#include <string>

#include "raw_peer.hpp"

namespace metier::system_tests {

// Bodies of requests, each about nodes that every server has.

WireBytes browseOf(std::size_t nodes);
/// Browse of the references in both directions of a node to which thousands refer, for a class that
/// none of them has.
WireBytes costlyBrowseOf(std::size_t nodes);
WireBytes readOf(std::size_t nodes);
WireBytes writeOf(std::size_t nodes);
WireBytes publish();

struct Subscribing {
    double interval_ms = 0.0;
    std::uint32_t lifetime_count = 10'000;
};
WireBytes subscriptionOf(const Subscribing& subscribing);

/// Monitored items of one node.
struct Items {
    std::size_t count = 1;
    bool events = false;  ///< events of the Server object; otherwise the values of CurrentTime
    std::uint32_t queue = 10'000;
};
WireBytes itemsOf(std::uint32_t subscription, const Items& items);

/// One call, or several the same.
struct Calling {
    std::uint16_t name_space = 0;
    std::string skill{};
    std::string method{};
    std::size_t count = 1;
};
WireBytes callOf(const Calling& calling);

/// Makes a Subscription that publishes as often as it can. \return its id, nothing if refused
std::optional<std::uint32_t> subscribe(RawPeer& peer);
/// The number at a place of an answer.
std::uint32_t numberAt(const std::string& answer, std::size_t place);

double doubleAt(const std::string& answer, std::size_t place);

}  // namespace metier::system_tests
