#include <fmt/format.h>

#include <memory>
#include <thread>
#include <utility>

#include "metier/base/queue.hpp"
#include "progress_view.hpp"
#include "servers.hpp"
#include "square_command.hpp"
#include "square_report.hpp"

namespace metier::app {
namespace {

constexpr std::size_t kUpdates = 10'000;

/// One arm with the connection it is moved over.
struct ConnectedArm {
    std::unique_ptr<opcua::Client> client;
    SquareArm arm;
};

Result<std::vector<ConnectedArm>> findArms(const std::vector<std::string>& urls) {
    std::vector<ConnectedArm> found;
    for (const auto& url : urls) {
        auto client = connectTo(url);
        if (!client) {
            return fail(client.error());
        }
        auto arms = findSquareArms(**client, url);
        if (!arms) {
            return fail(arms.error());
        }
        for (auto& arm : *arms) {
            if (*client == nullptr) {
                client = connectTo(url);  // a connection for each arm
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

struct Update {
    std::size_t row = 0;
    double fraction = 0;
    std::string text;
    bool last = false;
};

/// Moves all arms at the same time, one thread each; this one shows how it goes.
std::vector<SquareOutcome> moveAll(std::vector<ConnectedArm>& arms,
                                   const SquareSettings& settings) {
    std::vector<SquareOutcome> outcomes;
    std::vector<std::string> names;
    for (const auto& [client, arm] : arms) {
        names.push_back(arm.name);
        outcomes.push_back({arm.name, arm.url, fail(Errc::internal, "not run")});
    }
    ProgressView view(names, ProgressView::detect());
    Queue<Update> updates(kUpdates);
    std::vector<std::jthread> threads;
    for (std::size_t row = 0; row < arms.size(); ++row) {
        threads.emplace_back([&, row] {
            const auto tell = [&](double fraction, const std::string& text) {
                updates.tryPush({row, fraction, text, false});
            };
            outcomes[row].result = runSquare(*arms[row].client, arms[row].arm, settings, tell);
            updates.tryPush({row, 1.0, outcomes[row].result ? "done" : "failed", true});
        });
    }
    const auto deadline =
        std::chrono::steady_clock::now() + settings.move_timeout * (settings.laps * 4 + 2);
    for (std::size_t running = arms.size(); running > 0;) {
        const auto update = updates.popUntil(deadline);
        if (!update) {
            break;  // every move has its own deadline: the threads end soon
        }
        if (update->last) {
            view.finish(update->row, update->text);
            --running;
        } else {
            view.update(update->row, update->fraction, update->text);
        }
    }
    threads.clear();
    return outcomes;
}

struct SquareOptions {
    ServerChoice servers;
    SquareSettings settings;
    SquareOutput output;
};

Exit runSquareCommand(const SquareOptions& options) {
    const auto urls = addressesOf(options.servers);
    return urls ? moveAlongSquares(*urls, options.settings, options.output)
                : reportUsage(urls.error());
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

Exit moveAlongSquares(const std::vector<std::string>& urls, const SquareSettings& settings,
                      const SquareOutput& output) {
    auto arms = findArms(urls);
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

void addSquare(CLI::App& app, Exit& exit) {
    // Shared by CLI11, which fills it, and the callback, which reads it.
    auto options = std::make_shared<SquareOptions>();
    auto* command = app.add_subcommand(
        "square", "Move every arm of some servers along an upright square, and measure it");
    addServerChoice(*command, options->servers);
    addSquareOptions(*command, options->settings, options->output);
    command->callback([options, &exit] { exit = runSquareCommand(*options); });
}

}  // namespace metier::app
