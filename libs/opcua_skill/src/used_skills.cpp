#include "metier/opcua_skill/used_skills.hpp"

#include <array>
#include <utility>

#include "model_ids.hpp"

namespace metier::opcua_skill {

namespace {

using opcua::AddressSpace;
using opcua::NodeId;

const NodeId kNonHierarchicalReferences{0, 32U};
constexpr const char* kUsedSkills = "UsedSkills";

Result<NodeId> folderOf(AddressSpace& nodes, const NodeId& user, std::uint16_t metier) {
    return foundOrAdded(
        nodes, {.node = {.parent = user,
                         .browse_name = {metier, kUsedSkills},
                         .description = {"en", "The skills of other servers that it runs."}}});
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
    METIER_ASSIGN(const auto uses,
                  typeDirectlyBelow(nodes, kNonHierarchicalReferences, {metier, "UsesSkill"}));
    return nodes.addReference(user, uses, used);
}

Result<void> publishUse(AddressSpace& nodes, const NodeId& user, const RemoteSkill& used) {
    METIER_ASSIGN(const auto metier, nodes.namespaceIndex(kMetierUri));
    METIER_ASSIGN(const auto folder, folderOf(nodes, user, metier));
    METIER_ASSIGN(const auto type,
                  typeDirectlyBelow(nodes, opcua::ids::kBaseObjectType, {metier, "UsedSkillType"}));
    METIER_ASSIGN(
        const auto object,
        nodes.addObject({.node = {.parent = folder,
                                  .browse_name = {folder.namespaceIndex(), used.alias},
                                  .description = {"en", "Where the skill is that it calls " +
                                                            used.alias + "."}},
                         .type = type}));
    METIER_TRY(setProperties(nodes, object, metier, used));
    return publishUse(nodes, user, object);
}

Result<void> updateUse(AddressSpace& nodes, const NodeId& user, const RemoteSkill& used) {
    METIER_ASSIGN(const auto metier, nodes.namespaceIndex(kMetierUri));
    METIER_ASSIGN(const auto folder, nodes.find(user, {metier, kUsedSkills}));
    METIER_ASSIGN(const auto object, nodes.find(folder, {folder.namespaceIndex(), used.alias}));
    return setProperties(nodes, object, metier, used);
}

Result<void> publishRecipe(AddressSpace& nodes, const NodeId& skill, const std::string& recipe) {
    METIER_ASSIGN(const auto metier, nodes.namespaceIndex(kMetierUri));
    METIER_TRY(nodes.addVariable(
        {.node = {.parent = skill,
                  .reference = opcua::ids::kHasProperty,
                  .browse_name = {metier, std::string(kRecipe)},
                  .description = {"en",
                                  "The composition file that it was made of: steps, values "
                                  "and used skills."}},
         .type = opcua::ids::kPropertyType,
         .data_type = opcua::ids::kString,
         .value = opcua::Value::of(recipe)}));
    return {};
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
