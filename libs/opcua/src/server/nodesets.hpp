#pragma once

#include <open62541/server.h>
#include <spdlog/logger.h>

#include <filesystem>
#include <string>
#include <vector>

#include "metier/base/error.hpp"
#include "nodesets/data_types.hpp"
#include "nodesets/nodeset_file.hpp"

namespace metier::opcua {

/// Errors: not_found, naming it and those there are.
Result<> checkNodesets(const std::vector<std::string>& names);

/// Adds the named NodeSets and all of the skill model that they stand on, always in one order:
/// the compiled data types of NodeSets exist once per process and hold namespace indices.
/// Before the server runs. Errors: not_found (as above), internal (the stack).
Result<> loadNodesets(UA_Server* server, const std::vector<std::string>& names);

/// NodeSet2.xml files in memory, and the short names of the NodeSets that they need.
struct NodesetFiles {
    std::vector<NodesetFile> files;
    std::vector<std::string> needed;
};

/// Reads files; waits for the disk.
/// Errors: not_found (no such file), invalid_argument with lines "file:line: why" (no NodeSet).
Result<NodesetFiles> readNodesetFiles(const std::vector<std::filesystem::path>& paths);

/// Adds the nodes of files in the order that their required models ask for. A file of a model that
/// is compiled in is not needed, and left out.
/// \param store must outlive the server
/// \param log   gets what was left out of the files
/// Errors: invalid_argument with lines "file:line: why": a required model that is nowhere, models
///         that require each other, nodes that cannot be added.
Result<> loadNodesetFiles(UA_Server* server, const NodesetFiles& files, DataTypeStore& store,
                          spdlog::logger& log);

}  // namespace metier::opcua
