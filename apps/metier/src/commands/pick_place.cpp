#include <memory>
#include <string>
#include <variant>

#include "pick_place_run.hpp"
#include "servers.hpp"
#include "value_text.hpp"

namespace metier::app {
namespace {

struct PickPlaceOptions {
    ServerChoice servers;
    PickPlaceSettings settings;
};

Exit runPickPlace(const PickPlaceOptions& options, const CommandIdentity& identity) {
    const auto urls = addressesOf(options.servers);
    return urls ? pickAndPlace(identity, *urls, options.settings) : reportUsage(urls.error());
}

/// An option that is a list of numbers, as "0.3,-0.1,0.2,3.14,0,0".
template <typename T>
void addNumbers(CLI::App& command, const std::string& name, T& target, skill::ValueType type,
                const std::string& description) {
    command.add_option_function<std::string>(
        name,
        [&target, type, name](const std::string& text) {
            const auto value = parseValue(type, text);
            if (!value) {
                throw CLI::ValidationError(name, value.error().message);
            }
            target = std::get<T>(*value);
        },
        description);
}

void addPickPlaceOptions(CLI::App& command, PickPlaceSettings& settings) {
    addNumbers(command, "--pick", settings.pick, skill::ValueType::frame,
               "Where the first part is grasped: x,y,z,a,b,c in the robot base frame [m, rad]");
    addNumbers(command, "--place", settings.place, skill::ValueType::frame,
               "Where the first part goes");
    addNumbers(command, "--step", settings.step, skill::ValueType::vector3,
               "From one part to the next: x,y,z [m]");
    command
        .add_option("--turn", settings.turn,
                    "From one part to the next, about z of the robot base [rad]")
        ->check(CLI::Range(-3.15, 3.15))
        ->capture_default_str();
    command.add_option("--parts", settings.parts, "How many parts")
        ->check(CLI::Range(1, 100'000))
        ->capture_default_str();
    command.add_option("--approach", settings.approach, "Distance to come in and leave [m]")
        ->check(CLI::Range(0.0, 0.5))
        ->capture_default_str();
    command
        .add_option("--force", settings.force, "Force to hold a part with [N]; 0: the gripper's")
        ->check(CLI::Range(0.0, 1000.0))
        ->capture_default_str();
    command.add_flag("--json", settings.json, "Print the result as JSON");
}

}  // namespace

void addPickPlace(CLI::App& app, CommandContext& context) {
    // Shared by CLI11, which fills it, and the callback, which reads it.
    auto options = std::make_shared<PickPlaceOptions>();
    auto* command = app.add_subcommand(
        "pick-place", "Have every PickPlaceSkill of some servers move a row of parts");
    command->footer(
        "A part that fails is told with the reason; the skill is Reset and takes the next.\n"
        "A skill that somebody else halts is left alone, with the parts that remain.\n"
        "Exit status 1 if a part was not placed.");
    addServerChoice(*command, options->servers);
    addPickPlaceOptions(*command, options->settings);
    command->callback(
        [options, &context] { context.exit = runPickPlace(*options, context.identity); });
}

}  // namespace metier::app
