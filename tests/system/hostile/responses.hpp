#pragma once

#include <cstdint>
#include <string>

#include "reader.hpp"
#include "writer.hpp"

namespace metier::hostile {

/// A request as far as an answer depends on it.
struct Asked {
    std::uint32_t type = 0;
    std::uint32_t handle = 0;
    std::uint32_t items = 1;  ///< nodes to read, to browse, ...
};
/// Takes a request apart, behind what the SecureChannel puts around it.
Asked readRequest(Reader reader);

/// What is special about the address space of a hostile server.
enum class Landscape {
    loops,    ///< a few nodes that refer to one another, types that are derived from themselves
    endless,  ///< each node has children that nobody has seen before
    plenty,   ///< more references and elements than anybody needs
};

/// The message that answers a request: header and body. Empty for what gets no answer.
Bytes respond(Writer writer, const Asked& asked, const std::string& url, Landscape landscape);
/// The response to OpenSecureChannel.
Bytes respondOpen(Writer writer, const Asked& asked);
Bytes serviceFault(Writer writer, const Asked& asked, std::uint32_t status);

}  // namespace metier::hostile
