#pragma once

#include "metier/composition/definition.hpp"
#include "problem.hpp"

namespace metier::composition {

/// What a definition alone tells to be wrong: names that there are none of, values that are used
/// before they are there, loops without an end, one skill in two branches at the same time.
Problems checkDefinition(const Definition& definition);

}  // namespace metier::composition
