#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "metier/opcua/server.hpp"

namespace metier::opcua::testing {

/// A NodeSet2.xml file of the model urn:test:MODEL, whose namespace index 1 is its own.
struct NodesetText {
    std::string model = "machine";
    /// Elements below UANodeSet, from line 12 on.
    std::string nodes{};
    /// URIs of required models; their namespace indices are 2, 3, ...
    std::vector<std::string> required{};
};

/// The text of the file. With one required model the nodes begin in line 13, and so on.
std::string textOf(const NodesetText& nodeset);

/// A folder for NodeSet files, removed at the end.
class NodesetFolder {
public:
    NodesetFolder();
    ~NodesetFolder();
    NodesetFolder(const NodesetFolder&) = delete;
    NodesetFolder& operator=(const NodesetFolder&) = delete;

    /// Writes a file and returns its path.
    std::filesystem::path write(const std::string& name, std::string_view text) const;
    std::filesystem::path write(const NodesetText& nodeset) const;

private:
    std::filesystem::path folder_;
};

/// A server with the nodes of the files.
Result<std::unique_ptr<Server>> serverWith(const std::vector<std::filesystem::path>& files);

}  // namespace metier::opcua::testing
