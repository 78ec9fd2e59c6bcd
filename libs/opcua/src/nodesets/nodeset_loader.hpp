#pragma once

#include <open62541/server.h>

#include <string>
#include <vector>

#include "metier/base/error.hpp"
#include "nodesets/data_types.hpp"
#include "nodesets/nodeset_file.hpp"

namespace metier::opcua {

/// Adds the nodes of NodeSet files to a server, file by file, exactly as they are there: nothing is
/// added to an instance that the file does not list.
///
/// Threading: the server's own thread, before it runs.
class NodesetLoader {
public:
    /// \param store must outlive the server
    NodesetLoader(UA_Server* server, DataTypeStore& store) : server_(server), store_(store) {}

    /// Adds a file whose required models are there.
    /// Errors: invalid_argument with a line "file:line: why" for each node that cannot be added.
    /// The
    ///         server is then not usable.
    Result<> load(const NodesetFile& file);

    /// What was left out of the files, and why, a line each: references to nodes that are not
    /// there, descriptions of data types.
    const std::vector<std::string>& notes() const noexcept { return notes_; }

private:
    UA_Server* server_;
    DataTypeStore& store_;
    std::vector<std::string> notes_;
};

}  // namespace metier::opcua
