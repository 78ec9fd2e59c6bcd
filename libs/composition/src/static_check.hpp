#pragma once

#include "metier/composition/definition.hpp"
#include "problem.hpp"

namespace metier::composition {

/// Finds the mistakes that a definition alone shows: unknown names, values that are used before
/// they exist, loops without an end, one skill in two branches at the same time.
Problems checkDefinition(const Definition& definition);

}  // namespace metier::composition
