// As many random steps as the command line says, or those of a file:
// `metier_histories [STEPS] [SEED]`, `metier_histories --replay FILE`.
#include <fmt/format.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>

#include "runner.hpp"

namespace metier::system_tests {
namespace {

constexpr std::size_t kLength = 100;
/// The sessions of cut connections stay; the server's shutdown takes longer with each.
constexpr std::size_t kHistoriesPerServer = 200;

int replay(const char* file) {
    std::ifstream stream(file);
    const auto history = historyFrom(std::string(std::istreambuf_iterator<char>(stream), {}));
    if (!history) {
        fmt::print(stderr, "{}: {}\n", file, history.error().message);
        return EXIT_FAILURE;
    }
    World world;
    const auto divergence = findDivergence(world, *history);
    fmt::print("{}", divergence ? divergence->text : "server and model agree\n");
    return divergence ? EXIT_FAILURE : EXIT_SUCCESS;
}

/// Whether a difference means nothing: on a very busy machine a client gives its connection up
/// after some seconds without an answer, and the rest of the history is not comparable.
bool isVoid(const Divergence& divergence) {
    return divergence.text.find("seen:\n  BadNotConnected") != std::string::npos ||
           divergence.text.find("seen:\n  BadConnectionClosed") != std::string::npos;
}

int walk(std::uint64_t steps, std::uint64_t seed) {
    const auto begin = std::chrono::steady_clock::now();
    auto world = std::make_unique<World>();
    RandomSteps random(seed);
    std::uint64_t taken = 0;
    std::uint64_t histories = 0;
    std::uint64_t void_histories = 0;
    for (; taken < steps; ++histories) {
        const auto history = random.history(kLength);
        const auto divergence = findDivergence(*world, history);
        if (divergence && !isVoid(*divergence)) {
            fmt::print("history {} of seed {}: {}", histories, seed, explain(*world, history));
            return EXIT_FAILURE;
        }
        taken += divergence ? 0 : kLength;
        void_histories += divergence ? 1 : 0;
        if (divergence || histories % kHistoriesPerServer == kHistoriesPerServer - 1) {
            world.reset();
            world = std::make_unique<World>();
        }
    }
    const std::chrono::duration<double> time = std::chrono::steady_clock::now() - begin;
    fmt::print(
        "{} steps in {} histories of seed {}, in {:.0f} s: server and model agree; {} more "
        "histories lost a connection\n",
        taken, histories - void_histories, seed, time.count(), void_histories);
    return EXIT_SUCCESS;
}

}  // namespace
}  // namespace metier::system_tests

int main(int argc, char** argv) {
    using namespace metier::system_tests;
    try {
        if (argc == 3 && std::string(argv[1]) == "--replay") {
            return replay(argv[2]);
        }
        return walk(argc > 1 ? std::stoull(argv[1]) : 1'000'000,
                    argc > 2 ? std::stoull(argv[2]) : 1);
    } catch (const std::exception& error) {
        fmt::print(stderr, "histories: {}\n", error.what());
        return EXIT_FAILURE;
    }
}
