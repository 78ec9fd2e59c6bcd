#pragma once

#include <cstdint>
#include <string>

#include "asked.hpp"
#include "writer.hpp"

namespace metier::hostile {

/// Peculiarity of a hostile server's address space.
enum class Landscape {
    loops,    ///< a few nodes that refer to one another, types that are derived from themselves
    endless,  ///< each node has new children, without end
    plenty,   ///< more references and elements than anybody needs
};

/// The message that answers a request: header and body. Empty for what gets no answer.
Bytes respond(Writer writer, const Asked& asked, const std::string& url, Landscape landscape);
/// The response to OpenSecureChannel.
Bytes respondOpen(Writer writer, const Asked& asked);
Bytes serviceFault(Writer writer, const Asked& asked, std::uint32_t status);

}  // namespace metier::hostile
