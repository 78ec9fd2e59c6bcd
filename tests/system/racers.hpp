#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "metier/base/error.hpp"

namespace metier::system_tests {

struct RaceOptions {
    std::uint64_t rounds = 500;          ///< on a skill
    std::uint64_t baseline_rounds = 50;  ///< on a Program of OPC 10000-10 without any binding
    std::size_t clients = 8;
    std::uint32_t seed = 1;  ///< for the clients' actions
};

/// Results of the rounds on one object.
struct RaceCount {
    std::uint64_t rounds = 0;
    std::uint64_t started = 0;  ///< rounds in which some Start was accepted
    /// Executions with a value that the client whose Start was accepted did not give.
    std::uint64_t mixed = 0;
};

struct RaceReport {
    RaceCount skill;
    RaceCount baseline;
    double seconds = 0;
    /// Other mistakes: two starts in a round, none though a client was entitled, an answer that the
    /// contract does not have, a result of other values than the execution's.
    std::vector<std::string> defects;
};

/// Runs a race. In each round every client writes values of its own, in an order of its own, and
/// calls Start; or leaves some values out, sends all with StartWith, or calls Start without a
/// write. All do so at the same time, over connections of their own; in every other round no client
/// goes on before all have written once. The skill returns the values with which it was started.
/// Threads: any; waits. Errors: a refusal of the server or of a connection before the race.
Result<RaceReport> runRace(const RaceOptions& options);

}  // namespace metier::system_tests
