#pragma once

#include <optional>

#include "metier/base/error.hpp"
#include "metier/cell/toml_file.hpp"
#include "metier/composition/definition.hpp"

namespace metier::composition {

/// The constant that a TOML value stands for; nothing if it is none.
std::optional<Literal> literalOf(const cell::TomlValue& value);

/// Converts the constant to a value of that type.
/// Errors: type_mismatch, with the notation of such a value.
Result<skill::Value> valueOf(const Literal& literal, skill::ValueType type);

/// Notation of a value of that type in a file, for messages.
std::string_view howToWrite(skill::ValueType type) noexcept;

}  // namespace metier::composition
