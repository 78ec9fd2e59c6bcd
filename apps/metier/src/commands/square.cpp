#include <memory>

#include "servers.hpp"
#include "squares.hpp"

namespace metier::app {
namespace {

struct SquareOptions {
    ServerChoice servers;
    SquareSettings settings;
    SquareOutput output;
};

Exit runSquareCommand(const SquareOptions& options, const CommandIdentity& identity) {
    const auto urls = addressesOf(options.servers);
    return urls ? moveAlongSquares(identity, *urls, options.settings, options.output)
                : reportUsage(urls.error());
}

}  // namespace

void addSquare(CLI::App& app, CommandContext& context) {
    // Shared by CLI11, which fills it, and the callback, which reads it.
    auto options = std::make_shared<SquareOptions>();
    auto* command = app.add_subcommand(
        "square", "Move every arm of some servers along an upright square, and measure it");
    addServerChoice(*command, options->servers);
    addSquareOptions(*command, options->settings, options->output);
    command->callback(
        [options, &context] { context.exit = runSquareCommand(*options, context.identity); });
}

}  // namespace metier::app
