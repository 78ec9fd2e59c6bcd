#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace metier::system_tests {

/// Behaviour of a hostile, or a broken, peer towards a server.
enum class Attack {
    deaf,        ///< asks for much and never reads an answer
    subscriber,  ///< 100 monitored items and 200 publish requests: a cable is pulled under it
    item_bomb,   ///< as many monitored items as it gets, sampled as fast as can be
    chunks,      ///< messages whose last chunk never comes, over as many connections as it gets
    sessions,    ///< 1,000 sessions, or as many as it gets, and then more and more
    events,      ///< skills started and halted flat out, and slow readers of their events
    requests,    ///< many connections that ask flat out, and read the answers
    costly,      ///< requests that cost the server the most, at the limit of their size
    half_open,   ///< connections that send nothing, little, or a false identity
};
inline constexpr std::array kAttacks{Attack::deaf,     Attack::subscriber, Attack::item_bomb,
                                     Attack::chunks,   Attack::sessions,   Attack::events,
                                     Attack::requests, Attack::costly,     Attack::half_open};

std::string_view toString(Attack attack);

/// Order for `metier_attacker`.
struct AttackOrder {
    Attack attack = Attack::deaf;
    std::string host{};  ///< IPv4 address
    std::uint16_t port = 0;
    std::chrono::seconds time{};        ///< then it ends by itself
    std::uint16_t name_space = 0;       ///< namespace of the skills' nodes
    std::vector<std::string> skills{};  ///< texts of their NodeIds, for Attack::events
    /// First messages of a client that the server does not trust, for Attack::half_open.
    std::string stranger{};
};

std::vector<std::string> argumentsOf(const AttackOrder& order);
/// Throws if they are not those of an order.
AttackOrder attackOrderFrom(const std::vector<std::string>& arguments);

/// Result of an attack so far.
struct AttackCount {
    std::uint64_t connections = 0;
    std::uint64_t refused = 0;  ///< connections, channels and sessions that it did not get
    std::uint64_t cut = 0;      ///< closed by the server, after it had accepted them
    std::uint64_t requests = 0;
};

/// Line that an attacker prints once its attack is under way, and at its end.
inline constexpr std::string_view kAttacking = "attacking";
inline constexpr std::string_view kAttacked = "attacked";

/// Attacks until the time is over or `stop` returns true; prints kAttacking as soon as it is in
/// full swing.
AttackCount carryOut(const AttackOrder& order, const std::function<bool()>& stop);

}  // namespace metier::system_tests
