#pragma once

#include "metier/composition/composition.hpp"
#include "metier/composition/definition.hpp"

namespace metier::composition {

/// Leaves out what a file marks as optional and the used skills do not have: the steps of a use
/// that nothing serves, arguments without a parameter, and the source of results that a used skill
/// does not give. Such a result is Null; its source is a constant.
Definition withoutMissing(Definition definition, const Descriptions& used);

}  // namespace metier::composition
