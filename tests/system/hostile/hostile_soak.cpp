// Hostile messages, as many as the command line says:
// `metier_hostile_client [MESSAGES] [SEED] [FIRST]`, and `... closed` against a closed server.
#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <string>
#include <vector>

#include "onslaught.hpp"

int main(int argc, char** argv) {
    using namespace metier::hostile;
    std::vector<std::string> words(argv + 1, argv + argc);
    OnslaughtOptions options{.tells = true};
    if (!words.empty() && words.back() == "closed") {
        words.pop_back();
        options.kind = ServerKind::closed;
        options.folder = std::filesystem::temp_directory_path() / "metier_hostile_client";
    }
    options.messages = !words.empty() ? std::stoull(words[0]) : 10'000'000;
    options.seed = words.size() > 1 ? std::stoull(words[1]) : 1;
    options.first = words.size() > 2 ? std::stoull(words[2]) : 0;
    try {
        const auto report = runOnslaught(options);
        fmt::print("{}\n", describe(options, report));
        return report.tally.defects.empty() ? EXIT_SUCCESS : EXIT_FAILURE;
    } catch (const std::exception& error) {
        fmt::print(stderr, "hostile client: {}\n", error.what());
        return EXIT_FAILURE;
    }
}
