#pragma once

#include <string>

#include "metier/cell/toml_file.hpp"
#include "metier/composition/definition.hpp"
#include "metier/skill/field.hpp"

namespace metier::composition {

/// Reads keys and types; what is wrong is noted in the file.
Definition readDefinition(const cell::TomlFile& file, std::string name);

/// Steps of `[[key]]` and all within them.
std::vector<Step> readSteps(const cell::TomlTable& table, const std::string& key,
                            const std::string& path);

/// `key = "Parameter"` or `key = "step.Result"`, and which number of it.
Reference readReference(const cell::TomlTable& table, std::string_view key,
                        std::string_view element_key);

/// A constant, `{ from = "..." }`, or a list of numbers that holds either.
Binding readBinding(const cell::TomlValue& value, std::string key);

Condition readCondition(const cell::TomlTable& table, std::string key);

/// The keys of a parameter or result: type, unit, range, length, description.
skill::Field readField(const cell::TomlTable& table, const std::string& name);
/// The same, with default and optional.
Declaration readParameter(const cell::TomlTable& table, const std::string& name);

/// The URI of a namespace, and what may be left out; notes a text that is none.
std::string readNamespace(const cell::TomlTable& table, std::string preset);

/// Whether it can be the name of a skill, a parameter, a step; notes it if not.
bool checkName(const cell::TomlTable& table, std::string_view key, const std::string& name,
               std::size_t longest);

}  // namespace metier::composition
