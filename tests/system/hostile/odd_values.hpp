#pragma once

#include "known.hpp"

namespace metier::hostile {

/// Values of any type: scalars, arrays with dimensions, Variants in Variants up to the depth that
/// decoders must refuse (OPC 10000-6, 5.1.10), DataValues in them.
void writeVariant(Writer& writer, const Known& known);
void writeDataValue(Writer& writer, const Known& known);
/// DiagnosticInfos in one another.
void writeDiagnostic(Writer& writer);

/// One known, or an odd one.
const Bytes& anyNode(Random& random, const Known& known);
const Bytes& anyVariable(Random& random, const Known& known);
std::uint32_t anySubscription(Random& random, const Known& known);
std::uint32_t anyItem(Random& random, const Known& known);

}  // namespace metier::hostile
