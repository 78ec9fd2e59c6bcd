// As many late commands as the command line says: `metier_replays [ROUNDS] [SEED]`.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdlib>
#include <string>

#include "replays.hpp"

int main(int argc, char** argv) {
    metier::system_tests::ReplayOptions options;
    options.rounds = argc > 1 ? std::stoull(argv[1]) : 10'000;
    options.seed = argc > 2 ? static_cast<std::uint32_t>(std::stoul(argv[2])) : 1;
    options.folder = std::filesystem::temp_directory_path() / "metier_replays_soak";
    const auto report = metier::system_tests::runReplays(options);
    if (!report) {
        fmt::print(stderr, "replays: {}\n", report.error().message);
        return EXIT_FAILURE;
    }
    for (const auto& [answer, count] : report->answers) {
        fmt::print("{:>6}  {}\n", count, answer);
    }
    fmt::print(
        "{} late commands in {} lives of a server, {} starts that were meant, {:.0f} s, "
        "{} defects\n{}",
        report->rounds, report->boots, report->starts, report->seconds, report->defects.size(),
        fmt::join(report->defects, "\n"));
    return report->defects.empty() ? EXIT_SUCCESS : EXIT_FAILURE;
}
