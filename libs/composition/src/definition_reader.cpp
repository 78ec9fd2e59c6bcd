#include "definition_reader.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "literal.hpp"
#include "metier/composition/definition_file.hpp"
#include "metier/skill/field.hpp"
#include "static_check.hpp"

namespace metier::composition {

namespace {

using cell::TomlFile;
using cell::TomlTable;
using skill::Field;
using skill::Unit;
using skill::ValueType;

constexpr double kRestTime = 6.0;
constexpr double kLongestRestTime = 3600.0;
constexpr std::size_t kLongestName = 80;

constexpr std::array kTypes{ValueType::boolean, ValueType::int32,   ValueType::uint32,
                            ValueType::uint64,  ValueType::number,  ValueType::text,
                            ValueType::frame,   ValueType::vector3, ValueType::numbers,
                            ValueType::texts,   ValueType::ranges,  ValueType::frames};

/// A key of a table.
struct KeyOf {
    const TomlTable& table;
    std::string_view key;
};

/// The element of `known` that is called `name`; notes it at the key if there is none.
template <typename List, typename NameOf>
auto choose(const KeyOf& at, const std::string& name, const List& known, NameOf name_of) {
    const auto found = std::find_if(known.begin(), known.end(),
                                    [&](const auto& one) { return name_of(one) == name; });
    if (found != known.end()) {
        return *found;
    }
    std::vector<std::string_view> names;
    for (const auto& one : known) {
        names.push_back(name_of(one));
    }
    at.table.reject(at.key,
                    fmt::format("\"{}\" is none of: \"{}\"", name, fmt::join(names, "\", \"")));
    return known.front();
}

void readLength(const TomlTable& table, Field& field) {
    const auto length = table.value("length");
    if (!length) {
        return;
    }
    const auto whole = [](const cell::TomlValue& value) {
        const auto number = value.integer();
        return number && *number >= 0 ? std::optional(static_cast<std::size_t>(*number))
                                      : std::nullopt;
    };
    const auto items = length->items();
    const auto least = items.empty() ? whole(*length) : whole(items.front());
    const auto most = items.empty() ? least : whole(items.back());
    if (!least || !most || *least > *most || items.size() > 2) {
        length->reject("is not a number of elements, nor [least, most]");
        return;
    }
    field.length = skill::LengthLimit{*least, *most};
}

void readRange(const TomlTable& table, Field& field) {
    if (!table.has("range")) {
        return;
    }
    const auto range = table.numbers("range");
    if (range.size() != 2 || range[0] > range[1]) {
        table.reject("range", "is not [lowest, highest]");
    } else if (field.type == ValueType::frame || field.type == ValueType::frames) {
        table.reject("range", "frames have none");
    } else {
        field.range = skill::Range{range[0], range[1]};
    }
}

void readDefault(const TomlTable& table, Field& field) {
    const auto given = table.value("default");
    if (!given) {
        return;
    }
    const auto literal = literalOf(*given);
    auto value = literal ? valueOf(*literal, field.type)
                         : Result<skill::Value>(fail(Errc::type_mismatch, "is no constant"));
    if (value) {
        if (const auto fits = checkValue(field, *value); !fits) {
            value = fail(fits.error());
        }
    }
    if (!value) {
        given->reject(value.error().message);
        return;
    }
    field.default_value = std::move(*value);
}

Declaration readResult(const TomlTable& table, const std::string& name) {
    Declaration result{.line = table.line(), .field = readField(table, name), .from = {}};
    result.field.place = skill::Place::final_result;
    result.field.optional = table.flagOr("optional", false);
    const auto key = fmt::format("results.{}.from", name);
    result.from = Binding{.line = table.line(), .key = key};
    result.from.source = readReference(table, "from", "element");
    return result;
}

Use readUse(const TomlTable& table, const std::string& alias) {
    Use use{.line = table.line(),
            .alias = alias,
            .type = table.text("type"),
            .server = table.textOr("server", ""),
            .controller = table.textOr("controller", "")};
    use.reach = table.amount("reach", "m");
    use.payload = table.amount("payload", "kg");
    use.reset = table.flagOr("reset", false);
    use.optional = table.flagOr("optional", false);
    use.force = table.textOr("force", "");
    return use;
}

/// Results of `read` for each table within `[key]`, in the order of the file.
template <typename T, typename Read>
std::vector<T> readEach(const TomlTable& root, std::string_view key, Read read) {
    std::vector<T> all;
    if (!root.has(key)) {
        return all;
    }
    const auto table = root.table(key);
    for (const auto& name : table.keys()) {
        checkName(table, name, name, kLongestName);
        all.push_back(read(table.table(name), name));
    }
    return all;
}

skill::OwnerLossAction readOwnerLoss(const TomlTable& root) {
    struct Choice {
        std::string_view name;
        skill::OwnerLossAction action;
    };
    constexpr std::array kChoices{Choice{"halt", skill::OwnerLossAction::halt},
                                  Choice{"suspend", skill::OwnerLossAction::suspend},
                                  Choice{"continue", skill::OwnerLossAction::keep_going}};
    return choose({root, "on_owner_loss"}, root.textOr("on_owner_loss", "halt"), kChoices,
                  [](const Choice& choice) { return choice.name; })
        .action;
}

std::chrono::nanoseconds readRestTime(const TomlTable& root) {
    const auto time = root.numberOr("rest_time", kRestTime);
    if (!(time > 0 && time <= kLongestRestTime)) {
        root.reject("rest_time",
                    fmt::format("{} s is not over 0 and up to {} s", time, kLongestRestTime));
        return {};
    }
    return std::chrono::duration_cast<std::chrono::nanoseconds>(
        std::chrono::duration<double>(time));
}

Result<Definition> checkedDefinition(Result<TomlFile> file, std::string name) {
    if (!file) {
        return fail(std::move(file.error()));
    }
    auto definition = readDefinition(*file, std::move(name));
    for (const auto& problem : checkDefinition(definition)) {
        file->note(problem.line, problem.key, problem.why);
    }
    METIER_TRY(file->finish());
    return definition;
}

}  // namespace

Field readField(const TomlTable& table, const std::string& name) {
    Field field{.name = name, .description = table.textOr("description", "")};
    field.type = choose({table, "type"}, table.text("type"), kTypes,
                        [](ValueType type) { return skill::toString(type); });
    field.unit = choose({table, "unit"}, table.textOr("unit", ""), skill::kUnits,
                        [](const Unit& unit) { return unit.symbol; });
    readRange(table, field);
    readLength(table, field);
    return field;
}

Declaration readParameter(const TomlTable& table, const std::string& name) {
    Declaration parameter{.line = table.line(), .field = readField(table, name), .from = {}};
    parameter.field.optional = table.flagOr("optional", false);
    readDefault(table, parameter.field);
    return parameter;
}

std::string readNamespace(const TomlTable& table, std::string preset) {
    if (!table.has("namespace") && !preset.empty()) {
        return preset;
    }
    auto uri = table.textOr("namespace", "");
    if (uri.find(':') == std::string::npos || uri.find_first_of(" \t\n") != std::string::npos) {
        table.reject("namespace", fmt::format("\"{}\" is no URI, such as urn:example:line", uri));
    }
    return uri;
}

bool checkName(const TomlTable& table, std::string_view key, const std::string& name,
               std::size_t longest) {
    const auto letter = [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
               c == '_' || c == '-';
    };
    if (!name.empty() && name.size() <= longest && std::all_of(name.begin(), name.end(), letter)) {
        return true;
    }
    table.reject(key, fmt::format("\"{}\" is no name: up to {} of the letters A to Z and a to z, "
                                  "digits, _ and -",
                                  name, longest));
    return false;
}

Definition readDefinition(const TomlFile& file, std::string name) {
    const auto root = file.root();
    Definition definition;
    definition.file = std::move(name);
    definition.text = file.content();
    definition.name = root.text("name");
    checkName(root, "name", definition.name, kLongestName);
    definition.type = root.textOr("type", definition.name + "Type");
    checkName(root, "type", definition.type, kLongestName);
    definition.type_namespace = readNamespace(root, "urn:metier:composition:" + definition.type);
    definition.base = root.textOr("base", definition.base);
    if (root.has("terms")) {
        definition.terms = root.texts("terms");
    }
    definition.description = root.textOr("description", "");
    definition.rest_time = readRestTime(root);
    definition.on_owner_loss = readOwnerLoss(root);
    definition.parameters = readEach<Declaration>(root, "parameters", readParameter);
    definition.results = readEach<Declaration>(root, "results", readResult);
    definition.uses = readEach<Use>(root, "uses", readUse);
    definition.root.kind = StepKind::sequence;
    definition.root.line = 1;
    definition.root.key = "step";
    definition.root.steps = readSteps(root, "step", "");
    if (definition.root.steps.empty()) {
        root.reject("step", "a composed skill needs at least one [[step]]");
    }
    return definition;
}

Result<Definition> parseDefinition(std::string_view text, std::string name) {
    return checkedDefinition(TomlFile::parse(text, name), name);
}

Result<Definition> loadDefinition(const std::filesystem::path& file) {
    return checkedDefinition(TomlFile::load(file), file.string());
}

}  // namespace metier::composition
