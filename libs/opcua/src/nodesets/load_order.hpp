#pragma once

#include <functional>
#include <string>
#include <vector>

#include "metier/base/error.hpp"
#include "nodesets/nodeset_file.hpp"

namespace metier::opcua {

/// Whether a model of that URI is loaded without a file.
using IsCompiledIn = std::function<bool(const std::string&)>;

/// The files in an order in which each comes after those whose models it requires. A file whose
/// models are all compiled in is left out. The pointers are of `files`.
/// Errors: invalid_argument with a line "file:line: why" for each required model that is nowhere,
///         for models that require each other, and for a model in two files.
Result<std::vector<const NodesetFile*>> inLoadOrder(const std::vector<NodesetFile>& files,
                                                    const IsCompiledIn& is_compiled_in);

}  // namespace metier::opcua
