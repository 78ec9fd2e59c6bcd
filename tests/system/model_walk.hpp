#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "metier/opcua/client.hpp"

namespace metier::system_tests {

/// Compares the instances of a server with what their types and interfaces make mandatory, as a
/// client sees it: children by their BrowseNames, at every depth, and at least one object for each
/// MandatoryPlaceholder (OPC 10000-3, 6.4.4).
class ModelWalk {
public:
    explicit ModelWalk(opcua::Client& client) : client_(client) {}

    /// A line "path lacks name" for each child that is not there, below a node.
    std::vector<std::string> missingBelow(const opcua::NodeId& root);
    /// Number of Objects and Variables that were compared.
    std::size_t instances() const noexcept { return seen_.size(); }

private:
    using References = std::vector<opcua::Reference>;
    /// Declarations of one name, that of the lowest type first.
    using Declarations = std::vector<opcua::Reference>;

    void compare(const opcua::NodeId& instance, const std::string& path,
                 const std::vector<opcua::NodeId>& declaring);
    void compare(const opcua::NodeId& instance, const std::string& path,
                 const Declarations& declarations);
    void comparePlaceholder(const opcua::NodeId& instance, const std::string& path,
                            const Declarations& declarations);
    std::map<opcua::QualifiedName, Declarations> declaredBy(
        const std::vector<opcua::NodeId>& declaring);
    /// Types and interfaces of an instance with all above them.
    std::vector<opcua::NodeId> typesOf(const opcua::Reference& instance);
    const std::vector<opcua::NodeId>& chain(const opcua::NodeId& type);
    References targets(const opcua::NodeId& node, const opcua::NodeId& type);
    References children(const opcua::NodeId& node);
    const References& references(const opcua::NodeId& node);

    opcua::Client& client_;
    std::vector<std::string> missing_;
    std::set<opcua::NodeId> seen_;
    std::map<opcua::NodeId, References> references_;
    std::map<opcua::NodeId, std::vector<opcua::NodeId>> chains_;
};

}  // namespace metier::system_tests
