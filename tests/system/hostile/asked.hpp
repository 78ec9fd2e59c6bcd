#pragma once

#include <cstdint>

#include "reader.hpp"

namespace metier::hostile {

/// A request as far as an answer depends on it.
struct Asked {
    std::uint32_t type = 0;
    std::uint32_t handle = 0;
    std::uint32_t items = 1;  ///< nodes to read, to browse, ...
};
/// Takes a request apart, behind what the SecureChannel puts around it.
Asked readRequest(Reader reader);

}  // namespace metier::hostile
