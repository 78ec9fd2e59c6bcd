#include "squares.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "servers.hpp"
#include "side_by_side.hpp"
#include "square_report.hpp"

namespace metier::app {
namespace {

/// One arm with the connection it is moved over.
struct ConnectedArm {
    std::unique_ptr<opcua::Client> client;
    SquareArm arm;
};

Result<std::vector<ConnectedArm>> findArms(const CommandIdentity& identity,
                                           const std::vector<std::string>& urls) {
    std::vector<ConnectedArm> found;
    for (const auto& url : urls) {
        auto client = connectTo(identity, url);
        if (!client) {
            return fail(client.error());
        }
        METIER_ASSIGN(auto arms, findSquareArms(**client, url));
        for (auto& arm : arms) {
            if (*client == nullptr) {
                client = connectTo(identity, url);  // a connection for each arm
                if (!client) {
                    return fail(client.error());
                }
            }
            found.push_back({std::move(*client), std::move(arm)});
        }
    }
    if (found.empty()) {
        return fail(Errc::not_found,
                    "no arm with CartesianPtpMoveSkill and CartesianLinearMoveSkill found");
    }
    return found;
}

/// Moves all arms at the same time.
std::vector<SquareOutcome> moveAll(std::vector<ConnectedArm>& arms,
                                   const SquareSettings& settings) {
    std::vector<SquareOutcome> outcomes;
    std::vector<std::string> names;
    for (const auto& [client, arm] : arms) {
        names.push_back(arm.name);
        outcomes.push_back({arm.name, arm.url, fail(Errc::internal, "not run")});
    }
    runSideBySide(names, settings.move_timeout * (settings.laps * 4 + 2),
                  [&](std::size_t row, const TellRow& tell) {
                      auto& arm = arms[row];
                      outcomes[row].result = runSquare(*arm.client, arm.arm, settings, tell);
                      return outcomes[row].result.has_value();
                  });
    return outcomes;
}

}  // namespace

void addSquareOptions(CLI::App& command, SquareSettings& settings, SquareOutput& output) {
    command.add_option("--laps", settings.laps, "How many times around")
        ->check(CLI::Range(1, 100'000))
        ->capture_default_str();
    command.add_option("--side", settings.side, "Length of a side [m]")
        ->check(CLI::Range(0.001, 2.0))
        ->capture_default_str();
    command.add_option("--svg", output.svg, "Draw the measured paths into this file")
        ->capture_default_str();
    command.add_flag("--json", output.json, "Print the result as JSON");
}

Exit moveAlongSquares(const CommandIdentity& identity, const std::vector<std::string>& urls,
                      const SquareSettings& settings, const SquareOutput& output) {
    auto arms = findArms(identity, urls);
    if (!arms) {
        return report(arms.error());
    }
    const auto outcomes = moveAll(*arms, settings);
    fmt::print("{}", output.json ? jsonOf(outcomes) : tableOf(outcomes));
    if (const auto drawn = writePicture(output.svg, outcomes); !drawn) {
        return reportUsage(drawn.error());
    }
    fmt::print(stderr, "the paths are drawn in {}\n", output.svg);
    const bool all_done = std::all_of(outcomes.begin(), outcomes.end(), [](const auto& outcome) {
        return outcome.result.has_value();
    });
    return all_done ? Exit::success : Exit::failed;
}

}  // namespace metier::app
