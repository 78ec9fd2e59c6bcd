#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "metier/base/error.hpp"

namespace metier::system_tests {

struct StormOptions {
    std::uint64_t transitions = 50'000;  ///< the storm ends once the server counts as many
    std::size_t clients = 8;
    std::size_t skills = 4;
    std::uint32_t seed = 1;  ///< for the clients' actions
};

struct StormReport {
    std::uint64_t transitions = 0;  ///< as the server counts them
    std::uint64_t events = 0;       ///< received by all clients together
    double seconds = 0;
    std::vector<std::string> defects;  ///< lost, out of order or not answered
};

/// Clients start, halt and reset skills that do nothing, all at the same time and all the same
/// skills, on a server in this process. Each client subscribes to the events of every skill and
/// checks that it sees each transition that the server made, once and in order.
///
/// Half of the skills finish inside Start, half on another thread a moment later.
/// Threads: any; waits. Errors: what the server or a connection refused before the storm.
Result<StormReport> runStorm(const StormOptions& options);

}  // namespace metier::system_tests
