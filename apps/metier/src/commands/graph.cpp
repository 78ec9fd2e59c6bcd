#include <fmt/format.h>

#include <unistd.h>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>

#include "command_context.hpp"
#include "metier/composition/definition_file.hpp"
#include "metier/composition/dot.hpp"
#include "metier/link/child_process.hpp"

namespace metier::app {
namespace {

constexpr auto kLongestDrawing = std::chrono::seconds(30);

struct GraphOptions {
    std::string file;
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

Result<Exit> runGraph(const GraphOptions& options) {
    METIER_ASSIGN(const auto definition, asUsage(composition::loadDefinition(options.file)));
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
        "graph", "Draw the steps of a composition file, as text of Graphviz or as SVG");
    command->footer("The file is checked first: what is wrong is told with file, line and key.");
    command->add_option("file", options->file, "The composition file")->required();
    command->add_option("--format", options->format, "dot, or svg, which needs Graphviz")
        ->check(CLI::IsMember({"dot", "svg"}))
        ->capture_default_str();
    command->callback([options, &context] { context.exit = exitOf(runGraph(*options)); });
}

}  // namespace metier::app
