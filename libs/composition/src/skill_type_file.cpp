#include "metier/composition/skill_type_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "definition_reader.hpp"
#include "metier/cell/toml_file.hpp"

namespace metier::composition {

namespace {

using cell::TomlFile;
using cell::TomlTable;
using skill::SkillType;
using skill::TypeProperty;

constexpr std::size_t kLongestTypeName = 80;

/// Calls read(table, name) for each table within `[key]`.
template <typename Read>
void forEachTable(const TomlTable& table, std::string_view key, Read read) {
    if (!table.has(key)) {
        return;
    }
    const auto inner = table.table(key);
    for (const auto& name : inner.keys()) {
        checkName(inner, name, name, kLongestTypeName);
        read(inner.table(name), name);
    }
}

skill::Unit readUnit(const TomlTable& table) {
    const auto symbol = table.textOr("unit", "");
    if (symbol == skill::kHertz.symbol) {
        return skill::kHertz;
    }
    const auto* const found =
        std::find_if(skill::kUnits.begin(), skill::kUnits.end(),
                     [&](const skill::Unit& unit) { return unit.symbol == symbol; });
    if (found == skill::kUnits.end()) {
        table.reject("unit", fmt::format("\"{}\" is no unit that fields have", symbol));
        return skill::kOne;
    }
    return *found;
}

TypeProperty readProperty(const TomlTable& table, const std::string& name) {
    TypeProperty property;
    property.name = name;
    property.unit = readUnit(table);
    property.description = table.textOr("description", "");
    const auto value = table.value("value");
    if (!value) {
        table.reject("value", "missing; needs true, false, a number or a text");
    } else if (const auto number = value->number()) {
        property.value = *number;
    } else if (const auto text = value->text()) {
        property.value = *text;
    } else if (const auto flag = value->flag()) {
        property.value = *flag;
    } else {
        value->reject("is neither true, false, a number nor a text");
    }
    if (!(property.unit == skill::kOne) && !std::holds_alternative<double>(property.value)) {
        table.reject("unit", "only a number has a unit");
    }
    return property;
}

void readFacts(const TomlTable& table, SkillType& type) {
    if (table.has("terms")) {
        type.terms = table.texts("terms");
    }
    forEachTable(table, "properties", [&](const TomlTable& property, const std::string& name) {
        type.properties.push_back(readProperty(property, name));
    });
}

SkillType readType(const TomlTable& table) {
    SkillType type;
    type.name = table.text("name");
    checkName(table, "name", type.name, kLongestTypeName);
    type.base = table.textOr("base", type.base);
    type.description = table.textOr("description", "");
    std::vector<skill::Field> parameters;
    forEachTable(table, "parameters", [&](const TomlTable& field, const std::string& name) {
        parameters.push_back(readParameter(field, name).field);
    });
    type.parameters = std::move(parameters);
    std::vector<skill::Field> results;
    forEachTable(table, "results", [&](const TomlTable& field, const std::string& name) {
        results.push_back(readField(field, name));
        results.back().place = skill::Place::final_result;
        results.back().optional = field.flagOr("optional", false);
    });
    type.results = std::move(results);
    readFacts(table, type);
    return type;
}

SkillType readExtension(const TomlTable& table) {
    SkillType type;
    type.extends = true;
    type.name = table.text("type");
    readFacts(table, type);
    return type;
}

Result<skill::SkillTypes> readTypes(Result<TomlFile> file) {
    if (!file) {
        return fail(std::move(file.error()));
    }
    const auto root = file->root();
    skill::SkillTypes types;
    types.uri = readNamespace(root, "");
    types.version = root.textOr("version", types.version);
    for (const auto& table : root.tables("type")) {
        types.types.push_back(readType(table));
    }
    for (const auto& table : root.tables("extend")) {
        types.types.push_back(readExtension(table));
    }
    if (types.types.empty()) {
        root.reject("type", "needs at least one [[type]] or [[extend]]");
    }
    METIER_TRY(file->finish());
    return types;
}

}  // namespace

Result<skill::SkillTypes> loadSkillTypes(const std::filesystem::path& file) {
    return readTypes(TomlFile::load(file));
}

Result<skill::SkillTypes> parseSkillTypes(std::string_view text, std::string name) {
    return readTypes(TomlFile::parse(text, std::move(name)));
}

skill::SkillTypes skillTypesOf(const Definition& definition,
                               const skill::SkillDescription& description) {
    auto type = skill::skillTypeOf(description, definition.base);
    type.terms = definition.terms;
    skill::SkillTypes types;
    types.uri = definition.type_namespace;
    types.types.push_back(std::move(type));
    return types;
}

}  // namespace metier::composition
