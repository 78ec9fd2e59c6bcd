#include "survey.hpp"

#include <set>
#include <stdexcept>
#include <variant>

namespace metier::hostile {

namespace {

Bytes encoded(const opcua::NodeId& id) {
    if (const auto* number = std::get_if<std::uint32_t>(&id.identifier())) {
        return numericId(id.namespaceIndex(), *number);
    }
    const auto* text = std::get_if<std::string>(&id.identifier());
    return text == nullptr ? standardId(0) : textId(id.namespaceIndex(), *text);
}

}  // namespace

AddressMap survey(opcua::Client& client) {
    AddressMap map;
    std::set<opcua::NodeId> seen{opcua::ids::kObjectsFolder};
    std::vector<opcua::NodeId> open{opcua::ids::kObjectsFolder};
    while (!open.empty()) {
        const auto node = open.back();
        open.pop_back();
        const auto children = client.browse({.node = node});
        if (!children) {
            throw std::runtime_error(children.error().message);
        }
        for (const auto& child : *children) {
            if (!seen.insert(child.target).second) {
                continue;
            }
            map.nodes.push_back(encoded(child.target));
            if (child.node_class == opcua::NodeClass::method) {
                map.methods.push_back({encoded(node), encoded(child.target)});
            } else if (child.node_class == opcua::NodeClass::variable) {
                map.variables.push_back(encoded(child.target));
            }
            open.push_back(child.target);
        }
    }
    return map;
}

}  // namespace metier::hostile
