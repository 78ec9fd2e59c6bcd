#include "metier/opcua_skill/used_skills.hpp"

#include <array>
#include <utility>

#include "found_or_added.hpp"
#include "model_ids.hpp"

namespace metier::opcua_skill {

namespace {

using opcua::AddressSpace;
using opcua::NodeId;

const NodeId kNonHierarchicalReferences{0, 32U};
constexpr const char* kUsedSkills = "UsedSkills";

Result<NodeId> folderOf(AddressSpace& nodes, const NodeId& user, std::uint16_t metier) {
    opcua::ObjectSpec spec;
    spec.node.parent = user;
    spec.node.browse_name = {metier, kUsedSkills};
    spec.node.description = {"en", "The skills of other servers that it runs."};
    return foundOrAdded(nodes, spec);
}

Result<void> setProperties(AddressSpace& nodes, const NodeId& object, std::uint16_t metier,
                           const RemoteSkill& used) {
    const std::array<std::pair<const char*, const std::string*>, 4> properties{
        {{"EndpointUrl", &used.endpoint_url},
         {"SkillName", &used.name},
         {"SkillTypeName", &used.type_name},
         {"ControllerName", &used.controller}}};
    for (const auto& [name, value] : properties) {
        METIER_ASSIGN(const auto property, nodes.find(object, {metier, name}));
        METIER_TRY(nodes.write(property, opcua::Value::of(*value)));
    }
    return {};
}

}  // namespace

Result<void> publishUse(AddressSpace& nodes, const NodeId& user, const NodeId& used) {
    METIER_ASSIGN(const auto metier, nodes.namespaceIndex(kMetierUri));
    const auto uses = typeDirectlyBelow(nodes, kNonHierarchicalReferences, {metier, "UsesSkill"});
    return uses ? nodes.addReference(user, *uses, used) : Result<void>(fail(uses.error()));
}

Result<void> publishUse(AddressSpace& nodes, const NodeId& user, const RemoteSkill& used) {
    METIER_ASSIGN(const auto metier, nodes.namespaceIndex(kMetierUri));
    const auto folder = folderOf(nodes, user, metier);
    const auto type =
        typeDirectlyBelow(nodes, opcua::ids::kBaseObjectType, {metier, "UsedSkillType"});
    if (!folder || !type) {
        return fail(folder ? type.error() : folder.error());
    }
    opcua::ObjectSpec spec;
    spec.node.parent = *folder;
    spec.node.browse_name = {folder->namespaceIndex(), used.alias};
    spec.node.description = {"en", "Where the skill is that it calls " + used.alias + "."};
    spec.type = *type;
    METIER_ASSIGN(const auto object, nodes.addObject(spec));
    METIER_TRY(setProperties(nodes, object, metier, used));
    return publishUse(nodes, user, object);
}

Result<void> updateUse(AddressSpace& nodes, const NodeId& user, const RemoteSkill& used) {
    METIER_ASSIGN(const auto metier, nodes.namespaceIndex(kMetierUri));
    METIER_ASSIGN(const auto folder, nodes.find(user, {metier, kUsedSkills}));
    const auto object = nodes.find(folder, {folder.namespaceIndex(), used.alias});
    return object ? setProperties(nodes, *object, metier, used) : fail(object.error());
}

Result<NodeId> findSkillObject(const AddressSpace& nodes, const NodeId& skills,
                               const std::string& name) {
    METIER_ASSIGN(const auto children, nodes.browse(skills));
    for (const auto& child : children) {
        if (child.browse_name.name == name) {
            return child.target;
        }
    }
    return fail(Errc::not_found, "there is no skill " + name);
}

}  // namespace metier::opcua_skill
