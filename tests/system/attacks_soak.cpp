// Attacks on a server over a cable between network namespaces (MTU 1500), as root:
//   metier_attacks SECONDS [ATTACK...]     each attack for so long; prints what Halt took
//   metier_attacks SECONDS churn           strangers come and go while an operator connects
// Fails if Halt took longer than the bounds allow. `nice -n -20` puts it before
// the machine's other work.
#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <cstdlib>
#include <exception>

#include "attacks/churn.hpp"
#include "attacks/siege.hpp"

namespace metier::system_tests {
namespace {

constexpr const char* kLine = "{:<12}{:>8}{:>9}{:>9}{:>9}{:>9}{:>9}  {}\n";

constexpr std::uint16_t kManySessions = 1000;

bool siege(Cable& cable, Attack attack, std::chrono::seconds time) {
    opcua::ServerLimits limits;
    if (attack == Attack::sessions) {
        limits.sessions = kManySessions;
        limits.secure_channels = kManySessions + kManySessions / 10;
    }
    Siege siege(cable, limits, HaltBounds::strict);
    const auto outcome = siege.run(attack, time);
    const auto& during = outcome.during.answered;
    const auto ms = [](double value) { return fmt::format("{:.1f}", value); };
    fmt::print(
        kLine, toString(attack), during.count, ms(outcome.quiet.answered.p99_ms),
        ms(during.median_ms), ms(during.p99_ms), ms(during.max_ms), ms(outcome.load_ms),
        fmt::format("{} connections, {} refused, {} cut, {} requests", outcome.attack.connections,
                    outcome.attack.refused, outcome.attack.cut, outcome.attack.requests));
    if (!outcome.defect.empty()) {
        fmt::print("  {}\n", outcome.defect);
    }
    std::fflush(stdout);
    return outcome.defect.empty();
}

bool churn(Cable& cable, std::chrono::seconds time) {
    Churn churn(cable, std::filesystem::temp_directory_path() / "metier_churn", HaltBounds::strict);
    const auto outcome = churn.run(time);
    fmt::print(
        "churn: connecting takes {:.0f} ms at most without strangers; with {} connections of "
        "them {:.0f} ms ({} times, p99 {:.0f} ms) from another address, {:.0f} ms ({} times, "
        "p99 {:.0f} ms) from theirs; {} attempts\n{}\n",
        outcome.quiet.max_ms, outcome.attack.connections, outcome.near.max_ms, outcome.near.count,
        outcome.near.p99_ms, outcome.far.max_ms, outcome.far.count, outcome.far.p99_ms,
        outcome.attempts, outcome.defect);
    return outcome.defect.empty();
}

void allowManyFiles() {
    rlimit files{};
    ::getrlimit(RLIMIT_NOFILE, &files);
    files.rlim_cur = files.rlim_max;
    ::setrlimit(RLIMIT_NOFILE, &files);
}

int run(const std::vector<std::string>& arguments) {
    const auto time = std::chrono::seconds(arguments.empty() ? 60 : std::stol(arguments[0]));
    if (const auto obstacle = Cable::obstacle(); !obstacle.empty()) {
        fmt::print(stderr, "attacks: {}\n", obstacle);
        return EXIT_FAILURE;
    }
    allowManyFiles();
    Cable cable;
    if (arguments.size() == 2 && arguments[1] == "churn") {
        return churn(cable, time) ? EXIT_SUCCESS : EXIT_FAILURE;
    }
    fmt::print(kLine, "attack", "halts", "quiet99", "median", "p99", "max", "load",
               "[ms]; what the attacker did");
    bool clean = true;
    for (const auto attack : kAttacks) {
        const auto wanted =
            arguments.size() < 2 ||
            std::find(arguments.begin() + 1, arguments.end(), toString(attack)) != arguments.end();
        clean = (!wanted || siege(cable, attack, time)) && clean;
    }
    return clean ? EXIT_SUCCESS : EXIT_FAILURE;
}

}  // namespace
}  // namespace metier::system_tests

int main(int argc, char** argv) {
    try {
        return metier::system_tests::run({argv + 1, argv + argc});
    } catch (const std::exception& error) {
        fmt::print(stderr, "attacks: {}\n", error.what());
        return EXIT_FAILURE;
    }
}
