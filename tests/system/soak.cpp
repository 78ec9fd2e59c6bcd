// A storm of as many transitions as the command line says: `soak [TRANSITIONS] [SEED]`.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdlib>
#include <string>

#include "storm.hpp"

int main(int argc, char** argv) {
    metier::system_tests::StormOptions options;
    options.transitions = argc > 1 ? std::stoull(argv[1]) : 2'000'000;
    options.seed = argc > 2 ? static_cast<std::uint32_t>(std::stoul(argv[2])) : 1;
    const auto report = metier::system_tests::runStorm(options);
    if (!report) {
        fmt::print(stderr, "soak: {}\n", report.error().message);
        return EXIT_FAILURE;
    }
    fmt::print(
        "{} transitions by {} clients on {} skills in {:.1f} s: {:.0f}/s, {} events, "
        "{} defects\n{}",
        report->transitions, options.clients, options.skills, report->seconds,
        static_cast<double>(report->transitions) / report->seconds, report->events,
        report->defects.size(), fmt::join(report->defects, "\n"));
    const bool all_seen = report->events == report->transitions * options.clients;
    return report->defects.empty() && all_seen ? EXIT_SUCCESS : EXIT_FAILURE;
}
