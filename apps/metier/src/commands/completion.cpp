#include <fmt/format.h>

#include <memory>
#include <string>

#include "command_context.hpp"

namespace metier::app {
namespace {

/// The long options of a command, for the shell to offer.
std::string optionsOf(const CLI::App& command) {
    std::string words;
    for (const auto* option : command.get_options()) {
        for (const auto& name : option->get_lnames()) {
            words += (words.empty() ? "--" : " --") + name;
        }
    }
    return words;
}

std::string commandsOf(const CLI::App& app) {
    std::string words;
    for (const auto* command : app.get_subcommands(nullptr)) {
        words += (words.empty() ? "" : " ") + command->get_name();
    }
    return words;
}

/// A case for each command below a command, then one for the command itself.
std::string bashCases(const CLI::App& command) {
    std::string cases;
    for (const auto* below : command.get_subcommands(nullptr)) {
        cases += fmt::format("        \"{} {}\") words=\"{}\" ;;\n", command.get_name(),
                             below->get_name(), optionsOf(*below));
    }
    return cases + fmt::format("        \"{} \"*) words=\"{} {}\" ;;\n", command.get_name(),
                               commandsOf(command), optionsOf(command));
}

std::string bashScript(const CLI::App& app) {
    std::string cases;
    for (const auto* command : app.get_subcommands(nullptr)) {
        cases += bashCases(*command);
    }
    return fmt::format(R"(_metier() {{
    local current=${{COMP_WORDS[COMP_CWORD]}} words
    case "${{COMP_WORDS[1]}} ${{COMP_WORDS[2]}}" in
{}        *) words="{} {}" ;;
    esac
    COMPREPLY=($(compgen -W "$words" -- "$current"))
    [ "${{#COMPREPLY[@]}}" -gt 0 ] || COMPREPLY=($(compgen -f -- "$current"))
}}
complete -o filenames -F _metier metier
)",
                       cases, commandsOf(app), optionsOf(app));
}

std::string zshScript(const CLI::App& app) {
    return "autoload -U +X bashcompinit && bashcompinit\n" + bashScript(app);
}

/// The first line of a text in single quotes for fish.
std::string fishText(const std::string& text) {
    std::string quoted = "'";
    for (const char letter : text.substr(0, text.find('\n'))) {
        quoted += letter == '\'' || letter == '\\' ? "\\" : "";
        quoted += letter;
    }
    return quoted + "'";
}

/// The long options of a command, offered where `condition` holds.
std::string fishOptions(const CLI::App& command, const std::string& condition) {
    std::string script;
    for (const auto* option : command.get_options()) {
        for (const auto& name : option->get_lnames()) {
            script += fmt::format("complete -c metier -n '{}' -l {}\n", condition, name);
        }
    }
    return script;
}

std::string fishScript(const CLI::App& app) {
    std::string script = "complete -c metier -n __fish_use_subcommand -f\n";
    for (const auto* command : app.get_subcommands(nullptr)) {
        script += fmt::format("complete -c metier -n __fish_use_subcommand -a {} -d {}\n",
                              command->get_name(), fishText(command->get_description()));
        const auto seen = "__fish_seen_subcommand_from " + command->get_name();
        script += fishOptions(*command, seen);
        for (const auto* below : command->get_subcommands(nullptr)) {
            script += fmt::format("complete -c metier -n '{}' -a {} -d {}\n", seen,
                                  below->get_name(), fishText(below->get_description()));
            script += fishOptions(*below,
                                  seen + "; and __fish_seen_subcommand_from " + below->get_name());
        }
    }
    return script;
}

}  // namespace

void addCompletion(CLI::App& app, CommandContext& context) {
    // Shared by CLI11, which fills it, and the callback, which reads it.
    auto shell = std::make_shared<std::string>();
    auto* command = app.add_subcommand(
        "completion", "Print a completion script: source <(metier completion bash)");
    command->add_option("shell", *shell, "bash, zsh or fish")
        ->required()
        ->check(CLI::IsMember({"bash", "zsh", "fish"}));
    command->callback([shell, &app, &context] {
        const auto script = *shell == "bash"  ? bashScript(app)
                            : *shell == "zsh" ? zshScript(app)
                                              : fishScript(app);
        fmt::print("{}", script);
        context.exit = Exit::success;
    });
}

}  // namespace metier::app
