#pragma once

#include <string>

#include "metier/composition/definition.hpp"

namespace metier::composition {

/// The steps as a graph in Graphviz's language: boxes are used skills, in the order of the arrows;
/// dashed arrows lead to what follows a failure.
std::string toDot(const Definition& definition);

}  // namespace metier::composition
