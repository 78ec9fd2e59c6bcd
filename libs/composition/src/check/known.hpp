#pragma once

#include <optional>
#include <string>

#include "metier/composition/definition.hpp"

namespace metier::composition {

/// Result of a step on which a value depends, as in "grasp.Width": it is not known before the run.
/// Nothing if constants and parameters give the value.
std::optional<std::string> resultIn(const Binding& binding);
/// As resultIn(binding), of the values that a condition compares.
std::optional<std::string> resultIn(const Condition& condition);

}  // namespace metier::composition
