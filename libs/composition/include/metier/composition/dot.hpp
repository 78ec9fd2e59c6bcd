#pragma once

#include <string>

#include "metier/composition/definition.hpp"

namespace metier::composition {

/// Draws the steps as a graph in Graphviz's language. Boxes are used skills, in the order of the
/// arrows; dashed arrows lead to the steps that follow a failure. Threads: any; pure.
std::string toDot(const Definition& definition);

}  // namespace metier::composition
