#include <fmt/format.h>

#include <memory>
#include <string>

#include "command_context.hpp"
#include "metier/cell/toml_file.hpp"
#include "metier/composition/composition.hpp"
#include "metier/composition/definition_file.hpp"
#include "metier/composition/skill_type_file.hpp"
#include "metier/opcua_skill/skill_types.hpp"

namespace metier::app {
namespace {

/// A composition file has steps, a file of skill types has none.
Result<skill::SkillTypes> typesIn(const std::string& path) {
    METIER_ASSIGN(const auto file, cell::TomlFile::load(path));
    if (!file.root().has("step")) {
        return composition::loadSkillTypes(path);
    }
    METIER_ASSIGN(const auto definition, composition::loadDefinition(path));
    return composition::skillTypesOf(definition, composition::descriptionOf(definition));
}

Result<Exit> runExport(const std::string& path) {
    METIER_ASSIGN(const auto types, asUsage(typesIn(path)));
    METIER_ASSIGN(const auto text, asUsage(opcua_skill::nodesetOf(types)));
    fmt::print("{}", text);
    return Exit::success;
}

}  // namespace

void addTypes(CLI::App& app, CommandContext& context) {
    auto* types = app.add_subcommand("types", "Skill types that files declare");
    types->require_subcommand(1);
    // Shared by CLI11, which fills it, and the callback, which reads it.
    auto file = std::make_shared<std::string>();
    auto* command = types->add_subcommand(
        "export", "Print the skill types of a file as NodeSet2.xml, for other servers and clients");
    command->footer("The file is checked first: errors come with file, line and key.");
    command->add_option("file", *file, "A file of skill types, or a composition file")->required();
    command->callback([file, &context] { context.exit = exitOf(runExport(*file)); });
}

}  // namespace metier::app
