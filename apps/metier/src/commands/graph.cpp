#include <fmt/format.h>

#include <unistd.h>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <string>

#include "command_context.hpp"
#include "metier/client/skill_finder.hpp"
#include "metier/composition/definition_file.hpp"
#include "metier/composition/dot.hpp"
#include "metier/link/child_process.hpp"
#include "metier/opcua/text.hpp"
#include "metier/opcua_skill/namespaces.hpp"
#include "metier/opcua_skill/used_skills.hpp"
#include "servers.hpp"

namespace metier::app {
namespace {

constexpr auto kLongestDrawing = std::chrono::seconds(30);

struct GraphOptions {
    std::string source;  // a file, or the address of a server
    std::string skill;
    std::string format = "dot";
};

/// A file that the destructor removes.
class TemporaryFile {
public:
    explicit TemporaryFile(const std::string& text)
        : path_(std::filesystem::temp_directory_path() /
                fmt::format("metier_graph_{}.dot", getpid())) {
        std::ofstream(path_) << text;
    }
    ~TemporaryFile() {
        std::error_code ignored;
        std::filesystem::remove(path_, ignored);
    }
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;

    std::string path() const { return path_.string(); }

private:
    std::filesystem::path path_;
};

/// Picture that Graphviz makes.
Result<std::string> drawn(const std::string& dot) {
    const TemporaryFile file(dot);
    auto program = link::ChildProcess::start({"dot", "-Tsvg", file.path()});
    if (!program) {
        return fail(Errc::not_found,
                    "svg needs Graphviz, whose program `dot` is not there: apt-get install "
                    "graphviz, or take --format dot");
    }
    const auto deadline = std::chrono::steady_clock::now() + kLongestDrawing;
    std::string svg;
    for (auto line = program->readLine(deadline); line; line = program->readLine(deadline)) {
        svg += *line + "\n";
    }
    if (program->waitUntil(deadline) != 0) {
        return fail(Errc::internal, "Graphviz did not draw the graph");
    }
    return svg;
}

/// Composed skills of a server with the texts of their files, by name.
Result<std::map<std::string, std::string>> recipesOf(opcua::Client& client) {
    std::map<std::string, std::string> recipes;
    const auto metier = client.namespaceIndex(opcua_skill::kMetierUri);
    if (!metier) {
        return metier.error().code == Errc::not_found ? Result<decltype(recipes)>(recipes)
                                                      : fail(metier.error());
    }
    METIER_ASSIGN(const auto skills, client::findSkills(client));
    for (const auto& skill : skills) {
        const auto node =
            client.translate(skill.node, {{*metier, std::string(opcua_skill::kRecipe)}});
        if (node) {
            METIER_ASSIGN(const auto value, client.read(*node));
            METIER_ASSIGN(recipes[skill.name], value.as<std::string>());
        } else if (node.error().code != Errc::not_found) {
            return fail(node.error());
        }
    }
    return recipes;
}

/// Errors: invalid_argument if the server has no such composed skill, naming those that it has.
Result<composition::Definition> definitionOf(const CommandIdentity& identity,
                                             const GraphOptions& options) {
    METIER_ASSIGN(const auto client, connectTo(identity, options.source));
    METIER_ASSIGN(const auto recipes, recipesOf(*client));
    const auto chosen = options.skill.empty() && recipes.size() == 1 ? recipes.begin()
                                                                     : recipes.find(options.skill);
    if (chosen != recipes.end()) {
        return composition::parseDefinition(chosen->second, chosen->first);
    }
    std::string names;
    for (const auto& [name, recipe] : recipes) {
        names += (names.empty() ? "" : ", ") + opcua::sanitise(name);
    }
    return fail(Errc::invalid_argument,
                recipes.empty()
                    ? fmt::format("{}: none of its skills says what it is made of", options.source)
                    : fmt::format("{}: {}; its composed skills: {}", options.source,
                                  options.skill.empty() ? "name one of them"
                                                        : "no composed skill " + options.skill,
                                  names));
}

Result<Exit> runGraph(const CommandIdentity& identity, const GraphOptions& options) {
    METIER_ASSIGN(const auto definition,
                  isAddress(options.source) ? definitionOf(identity, options)
                                            : asUsage(composition::loadDefinition(options.source)));
    auto text = composition::toDot(definition);
    if (options.format == "svg") {
        METIER_ASSIGN(text, drawn(text));
    }
    fmt::print("{}", text);
    return Exit::success;
}

}  // namespace

void addGraph(CLI::App& app, CommandContext& context) {
    // Shared by CLI11, which fills it, and the callback, which reads it.
    auto options = std::make_shared<GraphOptions>();
    auto* command = app.add_subcommand(
        "graph", "Draw the steps of a composition, as text of Graphviz or as SVG");
    command->footer(
        "A file is checked first: errors come with file, line and key. A server "
        "publishes the file that a skill was made of as its Property Recipe.");
    command
        ->add_option("source", options->source,
                     "A composition file, or the address of a server: opc.tcp://host:port")
        ->required();
    command->add_option("skill", options->skill,
                        "Name of the skill of that server, if it has several composed ones");
    command->add_option("--format", options->format, "dot, or svg, which needs Graphviz")
        ->check(CLI::IsMember({"dot", "svg"}))
        ->capture_default_str();
    command->callback(
        [options, &context] { context.exit = exitOf(runGraph(context.identity, *options)); });
}

}  // namespace metier::app
