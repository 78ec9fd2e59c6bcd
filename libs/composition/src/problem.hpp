#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace metier::composition {

/// Something that is wrong with a file.
struct Problem {
    std::uint32_t line = 0;
    std::string key;  ///< "step[1].with.Force"
    std::string why;
};

using Problems = std::vector<Problem>;

}  // namespace metier::composition
