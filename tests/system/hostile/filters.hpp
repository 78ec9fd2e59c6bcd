#pragma once

#include "known.hpp"

namespace metier::hostile {

/// The filter of a monitored item, of any kind: event filters whose where clauses have operands of
/// every type, elements that refer to themselves and to none, and select clauses of any length.
void writeFilter(Writer& writer, const Known& known);

/// ContentFilter, as where clauses and queries have them.
void writeContentFilter(Writer& writer, const Known& known);

}  // namespace metier::hostile
