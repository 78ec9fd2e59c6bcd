#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "hostile_client.hpp"

namespace metier::hostile {

struct OnslaughtOptions {
    std::uint64_t seed = 1;
    std::uint64_t messages = 25'000;
    std::uint64_t first = 0;  ///< number of the first message, to go on from there
    std::size_t clients = 4;  ///< hostile ones; they take turns
    ServerKind kind = ServerKind::open;
    std::uint64_t ask_every = 100;  ///< messages between questions of the client that behaves
    /// Folder in which a closed server's certificates are made.
    std::string folder{};
    /// Prints how far it is.
    bool tells = false;
};

/// Behaviour of a server under attack.
struct OnslaughtReport {
    Tally tally;
    std::chrono::milliseconds longest_wait{};  ///< of the well-behaved client
    std::size_t resident_before = 0;           ///< [kB], when half of the messages were sent
    std::size_t resident_after = 0;            ///< [kB]
    std::size_t descriptors_before = 0;        ///< of the server, without hostile clients
    std::size_t descriptors_after = 0;         ///< after they have left
    double seconds = 0;
};

/// Starts a server with three skills as a process, and sends it messages while another client reads
/// the state of a skill again and again. A defect is: the server ends, answers late, does something
/// forbidden for a stranger, or a skill leaves Halted though nobody may reset it. Throws if it
/// cannot be set up.
OnslaughtReport runOnslaught(const OnslaughtOptions& options);

/// As text for people, with the seed.
std::string describe(const OnslaughtOptions& options, const OnslaughtReport& report);

}  // namespace metier::hostile
