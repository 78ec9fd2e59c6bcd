#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "metier/base/error.hpp"
#include "metier/opcua/node_id.hpp"
#include "metier/opcua/types.hpp"
#include "nodesets/nodeset_file.hpp"

namespace metier::opcua {

/// Translates the ids and names of a NodeSet file into those of the server that loads it: the
/// namespace indices differ, and a file may use aliases for NodeIds.
///
/// Threading: a value type.
class NodesetIds {
public:
    /// \param indices the server's indices of the file's namespaces 1, 2, ...
    NodesetIds(const NodesetFile& file, std::vector<std::uint16_t> indices);

    /// The server's NodeId of a text of the file: "ns=1;i=5", or an alias such as "HasComponent".
    /// Errors: invalid_argument, naming the text.
    Result<NodeId> nodeId(std::string_view text) const;
    /// The server's name of a BrowseName of the file: "1:Lamp", or "Lamp" for namespace 0.
    /// Errors: invalid_argument (a namespace that the file does not have).
    Result<QualifiedName> name(std::string_view text) const;
    /// The server's index of an index of the file. Errors: invalid_argument.
    Result<std::uint16_t> index(std::uint32_t of_file) const;

private:
    std::vector<std::uint16_t> indices_;
    std::map<std::string, std::string, std::less<>> aliases_;
};

}  // namespace metier::opcua
