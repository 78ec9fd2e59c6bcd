#include "nodesets/nodeset_ids.hpp"

#include <fmt/format.h>

#include <utility>

#include "metier/base/text.hpp"
#include "metier/opcua/text.hpp"

namespace metier::opcua {

NodesetIds::NodesetIds(const NodesetFile& file, std::vector<std::uint16_t> indices)
    : indices_(std::move(indices)) {
    indices_.insert(indices_.begin(), 0);
    for (const auto& alias : childNamed(file.root(), "Aliases").children()) {
        aliases_.emplace(alias.attribute("Alias").value(), textIn(alias));
    }
}

Result<std::uint16_t> NodesetIds::index(std::uint32_t of_file) const {
    if (of_file >= indices_.size()) {
        return fail(Errc::invalid_argument, fmt::format("namespace {}, but NamespaceUris has {}",
                                                        of_file, indices_.size() - 1));
    }
    return indices_[of_file];
}

Result<NodeId> NodesetIds::nodeId(std::string_view text) const {
    const auto alias = aliases_.find(trimmed(text));
    const std::string_view spelt = alias == aliases_.end() ? trimmed(text) : alias->second;
    METIER_ASSIGN(const auto id, NodeId::parse(spelt));
    METIER_ASSIGN(const auto of_server, index(id.namespaceIndex()));
    return std::visit([&](const auto& identifier) { return NodeId(of_server, identifier); },
                      id.identifier());
}

Result<QualifiedName> NodesetIds::name(std::string_view text) const {
    const auto colon = text.find(':');
    const auto prefix = numberIn<std::uint32_t>(text.substr(0, colon));
    if (colon == std::string_view::npos || !prefix) {
        return QualifiedName{0, std::string(text)};
    }
    METIER_ASSIGN(const auto of_server, index(*prefix));
    return QualifiedName{of_server, std::string(text.substr(colon + 1))};
}

}  // namespace metier::opcua
