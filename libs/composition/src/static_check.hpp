#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "metier/composition/definition.hpp"

namespace metier::composition {

/// Something that is wrong with a file.
struct Problem {
    std::uint32_t line = 0;
    std::string key;  ///< "step[1].with.Force"
    std::string why;
};

using Problems = std::vector<Problem>;

/// Finds the mistakes that a definition alone shows: unknown names, values that are used before
/// they exist, loops without an end, one skill in two branches at the same time.
Problems checkDefinition(const Definition& definition);

}  // namespace metier::composition
