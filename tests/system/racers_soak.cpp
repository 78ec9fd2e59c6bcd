// Races of 2 to 8 clients, as many rounds in all as the command line says:
// `metier_racers [ROUNDS] [SEED]`.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdlib>
#include <string>

#include "racers.hpp"

int main(int argc, char** argv) {
    using metier::system_tests::RaceOptions;
    constexpr std::size_t fewest = 2;
    constexpr std::size_t most = 8;
    constexpr std::uint64_t baseline_one_in = 20;
    const std::uint64_t rounds = argc > 1 ? std::stoull(argv[1]) : 100'000;
    const auto seed = argc > 2 ? static_cast<std::uint32_t>(std::stoul(argv[2])) : 1;
    std::uint64_t left = rounds;
    bool clean = true;
    for (std::size_t clients = fewest; clients <= most; ++clients) {
        const auto share = left / (most + 1 - clients);
        left -= share;
        const auto report = metier::system_tests::runRace(
            RaceOptions{share, share / baseline_one_in, clients, seed});
        if (!report) {
            fmt::print(stderr, "racers: {}\n", report.error().message);
            return EXIT_FAILURE;
        }
        fmt::print(
            "{} clients: skill {} rounds, {} started, {} mixed; plain Program {} rounds, {} "
            "started, {} mixed; {:.1f} s, {} defects\n{}",
            clients, report->skill.rounds, report->skill.started, report->skill.mixed,
            report->baseline.rounds, report->baseline.started, report->baseline.mixed,
            report->seconds, report->defects.size(), fmt::join(report->defects, "\n"));
        std::fflush(stdout);
        clean = clean && report->skill.mixed == 0 && report->defects.empty();
    }
    return clean ? EXIT_SUCCESS : EXIT_FAILURE;
}
