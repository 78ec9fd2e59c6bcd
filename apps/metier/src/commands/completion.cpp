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

std::string bashScript(const CLI::App& app) {
    std::string cases;
    for (const auto* command : app.get_subcommands(nullptr)) {
        cases +=
            fmt::format("        {}) words=\"{}\" ;;\n", command->get_name(), optionsOf(*command));
    }
    return fmt::format(R"(_metier() {{
    local current=${{COMP_WORDS[COMP_CWORD]}} words
    case ${{COMP_WORDS[1]}} in
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

std::string fishScript(const CLI::App& app) {
    std::string script = "complete -c metier -n __fish_use_subcommand -f\n";
    for (const auto* command : app.get_subcommands(nullptr)) {
        script += fmt::format("complete -c metier -n __fish_use_subcommand -a {} -d '{}'\n",
                              command->get_name(), command->get_description());
        for (const auto* option : command->get_options()) {
            for (const auto& name : option->get_lnames()) {
                script +=
                    fmt::format("complete -c metier -n '__fish_seen_subcommand_from {}' -l {}\n",
                                command->get_name(), name);
            }
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
