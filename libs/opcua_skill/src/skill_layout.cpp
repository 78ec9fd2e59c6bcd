#include "skill_layout.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

namespace metier::opcua_skill {

namespace {

using opcua::AddressSpace;
using opcua::BrowseFilter;
using opcua::NodeId;
using opcua::Reference;
using Direction = opcua::BrowseFilter::Direction;

const NodeId kAggregates{0, 44U};
const NodeId kHasModellingRule{0, 37U};
const NodeId kMandatory{0, 78U};
const NodeId kOptional{0, 80U};

/// Follows declarations from the top down and remembers what it has seen under which node.
class LayoutReader {
public:
    explicit LayoutReader(const AddressSpace& nodes) : nodes_(nodes) {}

    /// Adds the children that `type`, its supertypes and its interfaces declare.
    Result<void> addType(std::size_t parent, NodeId type) {
        while (!type.isNull()) {
            if (auto added = addDeclared(parent, type); !added) {
                return added;
            }
            if (auto added = addInterfaces(parent, type); !added) {
                return added;
            }
            auto super = superType(type);
            if (!super) {
                return fail(std::move(super.error()));
            }
            type = std::move(*super);
        }
        return {};
    }

    /// Adds what hangs below a node that is an instance.
    Result<void> addExisting(std::size_t parent, const NodeId& node) {
        auto children = nodes_.browse(node, {kAggregates, Direction::forward});
        if (!children) {
            return fail(std::move(children.error()));
        }
        for (auto& child : *children) {
            const NodeId target = child.target;
            const auto index = place(parent, std::move(child), LayoutNode::Rule::mandatory);
            if (auto added = addExisting(index, target); !added) {
                return added;
            }
        }
        return {};
    }

    SkillLayout take() && { return std::move(layout_); }

private:
    Result<NodeId> superType(const NodeId& type) const {
        auto above = nodes_.browse(type, {opcua::ids::kHasSubtype, Direction::inverse});
        if (!above) {
            return fail(std::move(above.error()));
        }
        return above->empty() ? NodeId() : above->front().target;
    }

    Result<void> addInterfaces(std::size_t parent, const NodeId& type) {
        auto interfaces = nodes_.browse(type, {opcua::ids::kHasInterface, Direction::forward});
        if (!interfaces) {
            return fail(std::move(interfaces.error()));
        }
        for (const auto& interface : *interfaces) {
            if (auto added = addType(parent, interface.target); !added) {
                return added;
            }
        }
        return {};
    }

    Result<void> addDeclared(std::size_t parent, const NodeId& declaring) {
        auto children = nodes_.browse(declaring, {kAggregates, Direction::forward});
        if (!children) {
            return fail(std::move(children.error()));
        }
        for (auto& child : *children) {
            const auto rule = ruleOf(child.target);
            if (!rule) {
                continue;
            }
            const NodeId target = child.target;
            const NodeId type = child.type_definition;
            const auto index = place(parent, std::move(child), *rule);
            if (auto added = addDeclared(index, target); !added) {
                return added;
            }
            if (auto added = addType(index, type); !added) {
                return added;
            }
        }
        return {};
    }

    /// Nothing for what no instance has: states, transitions, placeholders.
    std::optional<LayoutNode::Rule> ruleOf(const NodeId& declaration) const {
        const auto rules = nodes_.browse(declaration, {kHasModellingRule, Direction::forward});
        if (!rules || rules->empty()) {
            return std::nullopt;
        }
        if (rules->front().target == kMandatory) {
            return LayoutNode::Rule::mandatory;
        }
        if (rules->front().target == kOptional) {
            return LayoutNode::Rule::optional;
        }
        return std::nullopt;
    }

    /// The index of that child; a nearer declaration that is there already wins.
    std::size_t place(std::size_t parent, Reference child, LayoutNode::Rule rule) {
        auto& known = index_[{parent, child.browse_name}];
        if (known != 0) {
            return known - 1;
        }
        std::string path = parent == LayoutNode::kSkill ? "" : layout_[parent].path + "/";
        path += child.browse_name.name;
        layout_.push_back({std::move(path), parent, std::move(child), rule});
        known = layout_.size();
        return known - 1;
    }

    const AddressSpace& nodes_;
    SkillLayout layout_;
    std::map<std::pair<std::size_t, opcua::QualifiedName>, std::size_t> index_;  ///< plus one
};

}  // namespace

Result<SkillLayout> layoutOfType(const AddressSpace& nodes, const NodeId& type,
                                 const NodeId& also) {
    LayoutReader reader(nodes);
    for (const auto& one : {type, also}) {
        if (auto added = reader.addType(LayoutNode::kSkill, one); !added) {
            return fail(std::move(added.error()));
        }
    }
    return std::move(reader).take();
}

Result<SkillLayout> layoutOfInstance(const AddressSpace& nodes, const NodeId& instance) {
    LayoutReader reader(nodes);
    if (auto added = reader.addExisting(LayoutNode::kSkill, instance); !added) {
        return fail(std::move(added.error()));
    }
    return std::move(reader).take();
}

}  // namespace metier::opcua_skill
