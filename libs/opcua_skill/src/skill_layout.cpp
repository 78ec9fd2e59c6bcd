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
            METIER_TRY(addDeclared(parent, type));
            METIER_TRY(addInterfaces(parent, type));
            METIER_ASSIGN(auto super, superType(type));
            type = std::move(super);
        }
        return {};
    }

    /// Adds what hangs below a node that is an instance.
    Result<void> addExisting(std::size_t parent, const NodeId& node) {
        METIER_ASSIGN(auto children, nodes_.browse(node, {kAggregates, Direction::forward}));
        for (auto& child : children) {
            const NodeId target = child.target;
            const auto index = place(parent, std::move(child), LayoutNode::Rule::mandatory);
            METIER_TRY(addExisting(index, target));
        }
        return {};
    }

    SkillLayout take() && { return std::move(layout_); }

private:
    Result<NodeId> superType(const NodeId& type) const {
        METIER_ASSIGN(auto above,
                      nodes_.browse(type, {opcua::ids::kHasSubtype, Direction::inverse}));
        return above.empty() ? NodeId() : above.front().target;
    }

    Result<void> addInterfaces(std::size_t parent, const NodeId& type) {
        METIER_ASSIGN(auto interfaces,
                      nodes_.browse(type, {opcua::ids::kHasInterface, Direction::forward}));
        for (const auto& interface : interfaces) {
            METIER_TRY(addType(parent, interface.target));
        }
        return {};
    }

    Result<void> addDeclared(std::size_t parent, const NodeId& declaring) {
        METIER_ASSIGN(auto children, nodes_.browse(declaring, {kAggregates, Direction::forward}));
        for (auto& child : children) {
            const auto rule = ruleOf(child.target);
            if (!rule) {
                continue;
            }
            const NodeId target = child.target;
            const NodeId type = child.type_definition;
            const auto index = place(parent, std::move(child), *rule);
            METIER_TRY(addDeclared(index, target));
            METIER_TRY(addType(index, type));
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
        METIER_TRY(reader.addType(LayoutNode::kSkill, one));
    }
    return std::move(reader).take();
}

Result<SkillLayout> layoutOfInstance(const AddressSpace& nodes, const NodeId& instance) {
    LayoutReader reader(nodes);
    METIER_TRY(reader.addExisting(LayoutNode::kSkill, instance));
    return std::move(reader).take();
}

}  // namespace metier::opcua_skill
