#pragma once

#include <optional>

#include "metier/base/error.hpp"
#include "metier/cell/toml_file.hpp"
#include "metier/composition/definition.hpp"

namespace metier::composition {

/// The constant that a TOML value stands for; nothing if it is none.
std::optional<Literal> literalOf(const cell::TomlValue& value);

/// The constant as a value of that type.
/// Errors: type_mismatch, telling how such a value is written.
Result<skill::Value> valueOf(const Literal& literal, skill::ValueType type);

/// How a value of that type is written in a file.
std::string_view howToWrite(skill::ValueType type) noexcept;

}  // namespace metier::composition
