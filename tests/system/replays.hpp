#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "metier/base/error.hpp"

namespace metier::system_tests {

struct ReplayOptions {
    std::uint64_t rounds = 200;
    std::uint64_t rounds_per_boot = 16;  ///< then the server is started again
    std::uint32_t seed = 1;
    std::filesystem::path folder;  ///< for the server's names; its former content is lost
};

struct ReplayReport {
    std::uint64_t rounds = 0;
    std::uint64_t boots = 0;
    std::uint64_t starts = 0;  ///< starts that were meant, and happened
    /// Number of each answer to each kind of late command: "same name: BadNodeIdExists".
    std::map<std::string, std::uint64_t> answers;
    double seconds = 0;
    std::vector<std::string> defects;  ///< motions that must not be, and wrong answers
};

/// Clients start a skill in every way there is. Then each round brings a command that is too late:
/// a name, an epoch or a deadline of before, or the very bytes of a Start, on the connection that
/// it came over or on another; in the same life of the server or in a later one.
/// Threads: any; waits. Errors: what could not be set up.
Result<ReplayReport> runReplays(const ReplayOptions& options);

}  // namespace metier::system_tests
