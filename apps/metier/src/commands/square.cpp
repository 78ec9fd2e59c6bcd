#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

#include "metier/base/numbers.hpp"
#include "servers.hpp"
#include "side_by_side.hpp"
#include "squares.hpp"

namespace metier::app {
namespace {

/// Outcome of one arm: its result, or the reason why there is none.
struct SquareOutcome {
    std::string name;
    std::string url;
    Result<SquareResult> result;
};

std::string rowOf(const SquareOutcome& outcome) {
    if (!outcome.result) {
        return fmt::format("{:<14} failed: {}\n", outcome.name, outcome.result.error().message);
    }
    const auto& result = *outcome.result;
    const auto& measured = result.path.measurement;
    return fmt::format("{:<14} {:>4} {:>8.2f} {:>14.4f} {:>12.4f} {:>8}\n", outcome.name,
                       result.laps, result.time.count(),
                       measured.largest_deviation * kMillimetresPerMetre,
                       measured.closure_error * kMillimetresPerMetre, result.missed_cycles);
}

nlohmann::json jsonOf(const SquareOutcome& outcome) {
    nlohmann::json json{{"arm", outcome.name}, {"url", outcome.url}};
    if (!outcome.result) {
        json["error"] = outcome.result.error().message;
        return json;
    }
    const auto& result = *outcome.result;
    const auto& measured = result.path.measurement;
    json["laps"] = result.laps;
    json["time_s"] = result.time.count();
    json["deviation_mm"] = measured.largest_deviation * kMillimetresPerMetre;
    json["reported_deviation_mm"] = result.reported_deviation * kMillimetresPerMetre;
    json["closure_mm"] = measured.closure_error * kMillimetresPerMetre;
    json["missed_cycles"] = result.missed_cycles;
    json["samples"] = result.path.positions.size();
    return json;
}

/// A table for the terminal.
std::string tableOf(const std::vector<SquareOutcome>& outcomes) {
    auto table = fmt::format("{:<14} {:>4} {:>8} {:>14} {:>12} {:>8}\n", "arm", "laps", "time/s",
                             "deviation/mm", "closure/mm", "missed");
    for (const auto& outcome : outcomes) {
        table += rowOf(outcome);
    }
    return table;
}

std::string jsonOf(const std::vector<SquareOutcome>& outcomes) {
    auto json = nlohmann::json::array();
    for (const auto& outcome : outcomes) {
        json.push_back(jsonOf(outcome));
    }
    return json.dump(2) + "\n";
}

/// Writes the picture of all paths, and makes its folder if it is missing.
/// Errors: invalid_argument if the file cannot be written.
Result<void> writePicture(const std::string& file, const std::vector<SquareOutcome>& outcomes) {
    std::vector<path_evaluation::DrawnPath> paths;
    for (const auto& outcome : outcomes) {
        if (outcome.result) {
            paths.push_back(outcome.result->path);
        }
    }
    std::error_code
        ignored;  // a folder that cannot be made shows in the file that cannot be opened
    std::filesystem::create_directories(std::filesystem::absolute(file).parent_path(), ignored);
    return writeFile(file, path_evaluation::drawSvg(paths));
}

/// One arm with the connection it is moved over.
struct ConnectedArm {
    std::unique_ptr<opcua::Client> client;
    SquareArm arm;
};

/// Adds the arms of one server to `found`.
Result<void> findArmsAt(const CommandIdentity& identity, const std::string& url,
                        std::vector<ConnectedArm>& found, std::vector<Error>& left_out) {
    METIER_ASSIGN(auto client, connectTo(identity, url));
    METIER_ASSIGN(auto arms, findSquareArms(*client, url, left_out));
    for (auto& arm : arms) {
        if (client == nullptr) {
            METIER_ASSIGN(client, connectTo(identity, url));  // a connection for each arm
        }
        found.push_back({std::move(client), std::move(arm)});
    }
    return {};
}

Result<std::vector<ConnectedArm>> findArms(const CommandIdentity& identity,
                                           const std::vector<std::string>& urls) {
    std::vector<ConnectedArm> found;
    std::vector<Error> left_out;
    for (const auto& url : urls) {
        METIER_TRY(findArmsAt(identity, url, found, left_out));
    }
    if (found.empty()) {
        return fail(left_out.empty()
                        ? Error{Errc::not_found,
                                "no arm with CartesianPtpMoveSkill and CartesianLinearMoveSkill "
                                "found"}
                        : std::move(left_out.front()));
    }
    for (const auto& problem : left_out) {
        report(problem);
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

struct SquareOptions {
    ServerChoice servers;
    SquareSettings settings;
    SquareOutput output;
};

Result<Exit> runSquareCommand(const SquareOptions& options, const CommandIdentity& identity) {
    METIER_ASSIGN(const auto urls, addressesOf(options.servers));
    return moveAlongSquares(identity, urls, options.settings, options.output);
}

}  // namespace

void addSquareOptions(CLI::App& command, SquareSettings& settings, SquareOutput& output) {
    within(command.add_option("--laps", settings.laps, "How many times around"), 1, 100'000);
    within(command.add_option("--side", settings.side, "Length of a side [m]"), 0.001, 2.0);
    command.add_option("--svg", output.svg, "Draw the measured paths into this file")
        ->capture_default_str();
    command.add_flag("--json", output.json, "Print the result as JSON");
}

Result<Exit> moveAlongSquares(const CommandIdentity& identity, const std::vector<std::string>& urls,
                              const SquareSettings& settings, const SquareOutput& output) {
    METIER_ASSIGN(auto arms, findArms(identity, urls));
    const auto outcomes = moveAll(arms, settings);
    fmt::print("{}", output.json ? jsonOf(outcomes) : tableOf(outcomes));
    METIER_TRY(writePicture(output.svg, outcomes));
    fmt::print(stderr, "the paths are drawn in {}\n", output.svg);
    const bool all_done = std::all_of(outcomes.begin(), outcomes.end(), [](const auto& outcome) {
        return outcome.result.has_value();
    });
    return all_done ? Exit::success : Exit::failed;
}

void addSquare(CLI::App& app, CommandContext& context) {
    // Shared by CLI11, which fills it, and the callback, which reads it.
    auto options = std::make_shared<SquareOptions>();
    auto* command = app.add_subcommand(
        "square", "Move every arm of some servers along an upright square, and measure it");
    addServerChoice(*command, options->servers);
    addServerSearch(*command, options->servers);
    addSquareOptions(*command, options->settings, options->output);
    command->callback([options, &context] {
        context.exit = exitOf(runSquareCommand(*options, context.identity));
    });
}

}  // namespace metier::app
