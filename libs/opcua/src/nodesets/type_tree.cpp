#include "nodesets/type_tree.hpp"

#include "common/convert.hpp"
#include "metier/opcua/standard_ids.hpp"

namespace metier::opcua {

namespace {

/// No chain of types is longer, unless it is a circle.
constexpr int kMostTypesAbove = 200;

}  // namespace

std::optional<NodeId> TypeTree::source(const NodeId& target, const NodeId& reference_type) const {
    UA_BrowseDescription description{};
    description.nodeId = viewOf(target);
    description.referenceTypeId = viewOf(reference_type);
    description.browseDirection = UA_BROWSEDIRECTION_INVERSE;
    Owned<UA_BrowseResult> found(UA_Server_browse(server_, 0, &description),
                                 UA_TYPES[UA_TYPES_BROWSERESULT]);
    return found->referencesSize == 0
               ? std::nullopt
               : std::optional(fromNative(found->references[0].nodeId.nodeId));
}

std::optional<NodeId> TypeTree::above(const NodeId& type) const {
    auto known = above_.find(type);
    if (known == above_.end()) {
        known = above_.emplace(type, source(type, ids::kHasSubtype).value_or(NodeId())).first;
    }
    return known->second.isNull() ? std::nullopt : std::optional(known->second);
}

bool TypeTree::isA(const NodeId& type, const NodeId& base) const {
    auto each = std::optional(type);
    for (int depth = 0; each && depth < kMostTypesAbove; ++depth) {
        if (*each == base) {
            return true;
        }
        each = above(*each);
    }
    return false;
}

}  // namespace metier::opcua
