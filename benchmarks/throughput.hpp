#pragma once

#include <chrono>

#include "both_sides.hpp"

namespace metier::benchmarks {

enum class Watching { unseen, seen };

/// Executions of one Program that eight clients start, each of them again and again.
struct Throughput {
    double per_second = 0;
    double server_cpu = 0;      ///< share of a core, during the starts
    double server_thread = 0;   ///< CPU time of the server's own thread for each [us]
    double server_threads = 0;  ///< as well, of all threads of its process
};

/// Measures a server in a process of its own. Seen: each client gets all events of the Program.
Throughput throughput(const Side& side, Watching watching,
                      std::chrono::milliseconds time = std::chrono::seconds(2));

}  // namespace metier::benchmarks
