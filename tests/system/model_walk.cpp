#include "model_walk.hpp"

#include <algorithm>

namespace metier::system_tests {
namespace {

using opcua::NodeClass;
using opcua::NodeId;
using opcua::Reference;
namespace ids = opcua::ids;

const NodeId kHasModellingRule{0, 37U};
const NodeId kHasOrderedComponent{0, 49U};
const NodeId kHasAddIn{0, 17604U};
const NodeId kMandatory{0, 78U};
const NodeId kMandatoryPlaceholder{0, 11510U};

bool isChild(const Reference& reference) {
    return reference.type == ids::kHasComponent || reference.type == ids::kHasProperty ||
           reference.type == kHasOrderedComponent || reference.type == kHasAddIn;
}

bool isInstance(const Reference& reference) {
    return reference.node_class == NodeClass::object || reference.node_class == NodeClass::variable;
}

std::vector<NodeId> targetsOf(const std::vector<Reference>& references) {
    std::vector<NodeId> targets;
    for (const auto& reference : references) {
        targets.push_back(reference.target);
    }
    return targets;
}

}  // namespace

std::vector<std::string> ModelWalk::missingBelow(const NodeId& root) {
    std::vector<std::pair<NodeId, std::string>> open{{root, ""}};
    while (!open.empty()) {
        const auto [node, path] = std::move(open.back());
        open.pop_back();
        for (const auto& child : children(node)) {
            const auto below = path + "/" + child.browse_name.name;
            if (isInstance(child) && seen_.insert(child.target).second) {
                compare(child.target, below, typesOf(child));
                open.emplace_back(child.target, below);
            }
        }
    }
    return std::move(missing_);
}

void ModelWalk::compare(const NodeId& instance, const std::string& path,
                        const std::vector<NodeId>& declaring) {
    for (const auto& [name, declarations] : declaredBy(declaring)) {
        compare(instance, path, declarations);
    }
}

void ModelWalk::compare(const NodeId& instance, const std::string& path,
                        const Declarations& declarations) {
    const auto& declared = declarations.front();
    const auto rules = targetsOf(targets(declared.target, kHasModellingRule));
    if (rules == std::vector{kMandatoryPlaceholder}) {
        return comparePlaceholder(instance, path, declarations);
    }
    const auto below = children(instance);
    const auto found = std::find_if(below.begin(), below.end(), [&](const Reference& child) {
        return child.browse_name == declared.browse_name && child.node_class == declared.node_class;
    });
    if (found != below.end()) {
        compare(found->target, path + "/" + declared.browse_name.name, targetsOf(declarations));
    } else if (rules == std::vector{kMandatory}) {
        missing_.push_back(path + " lacks " + declared.browse_name.name);
    }
}

void ModelWalk::comparePlaceholder(const NodeId& instance, const std::string& path,
                                   const Declarations& declarations) {
    const auto& declared = declarations.front();
    bool found = false;
    for (const auto& child : children(instance)) {
        const auto& types = chain(child.type_definition);
        if (std::find(types.begin(), types.end(), declared.type_definition) != types.end()) {
            found = true;
            compare(child.target, path + "/" + child.browse_name.name, targetsOf(declarations));
        }
    }
    if (!found) {
        missing_.push_back(path + " lacks " + declared.browse_name.name);
    }
}

std::map<opcua::QualifiedName, ModelWalk::Declarations> ModelWalk::declaredBy(
    const std::vector<NodeId>& declaring) {
    std::map<opcua::QualifiedName, Declarations> declared;
    for (const auto& node : declaring) {
        for (const auto& child : children(node)) {
            declared[child.browse_name].push_back(child);
        }
    }
    return declared;
}

std::vector<NodeId> ModelWalk::typesOf(const Reference& instance) {
    auto types = chain(instance.type_definition);
    auto interfaces = targets(instance.target, ids::kHasInterface);
    for (const auto& type : chain(instance.type_definition)) {
        const auto more = targets(type, ids::kHasInterface);
        interfaces.insert(interfaces.end(), more.begin(), more.end());
    }
    for (const auto& interface : interfaces) {
        const auto& above = chain(interface.target);
        types.insert(types.end(), above.begin(), above.end());
    }
    return types;
}

/// The type and those above it; empty for the null id.
const std::vector<NodeId>& ModelWalk::chain(const NodeId& type) {
    const auto [entry, is_new] = chains_.try_emplace(type);
    auto& types = entry->second;
    for (auto each = type; is_new && !each.isNull();) {
        types.push_back(each);
        const auto above = client_.browse({.node = each,
                                           .reference_type = ids::kHasSubtype,
                                           .direction = opcua::BrowseDirection::inverse});
        each = above.value().empty() ? NodeId() : above.value().front().target;
    }
    return types;
}

ModelWalk::References ModelWalk::targets(const NodeId& node, const NodeId& type) {
    auto found = references(node);
    std::erase_if(found, [&](const Reference& each) { return each.type != type; });
    return found;
}

ModelWalk::References ModelWalk::children(const NodeId& node) {
    auto found = references(node);
    std::erase_if(found, [](const Reference& each) { return !isChild(each); });
    return found;
}

const ModelWalk::References& ModelWalk::references(const NodeId& node) {
    const auto known = references_.find(node);
    if (known != references_.end()) {
        return known->second;
    }
    auto found = client_.browse({.node = node, .reference_type = {}});
    return references_.emplace(node, std::move(found).value()).first->second;
}

}  // namespace metier::system_tests
