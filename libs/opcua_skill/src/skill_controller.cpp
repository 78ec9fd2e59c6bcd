#include "metier/opcua_skill/skill_controller.hpp"

#include <utility>

#include "model_ids.hpp"

namespace metier::opcua_skill {
namespace {

using opcua::AddressSpace;
using opcua::NodeId;
using opcua::Reference;

constexpr std::uint32_t kISkillControllerType = 15396;
constexpr std::uint32_t kIControlLeaseType = 20056;
constexpr std::uint32_t kLockingServicesType = 6388;
constexpr std::uint16_t kOwnNamespace = 1;

opcua::NodeSpec specOf(const NodeId& parent, const Reference& declaration) {
    return {.parent = parent, .browse_name = declaration.browse_name};
}

/// Arguments, units and ranges are the declaration's own.
Result<void> shareProperties(AddressSpace& nodes, const NodeId& node, const NodeId& declaration) {
    METIER_ASSIGN(const auto properties, nodes.browse(declaration, {opcua::ids::kHasProperty}));
    for (const auto& property : properties) {
        METIER_TRY(nodes.addReference(node, opcua::ids::kHasProperty, property.target));
    }
    return {};
}

Result<NodeId> addVariable(AddressSpace& nodes, const NodeId& parent,
                           const Reference& declaration) {
    METIER_ASSIGN(const auto shape, nodes.shapeOf(declaration.target));
    return nodes.addVariable({.node = specOf(parent, declaration),
                              .type = declaration.type_definition,
                              .data_type = shape.data_type,
                              .value_rank = shape.value_rank,
                              .children = opcua::Children::none});
}

/// Adds the nodes that the lease's interface declares to the controller itself.
Result<void> addLease(AddressSpace& nodes, const NodeId& controller, const NodeId& interface) {
    METIER_ASSIGN(const auto declared, nodes.browse(interface, {opcua::ids::kHasComponent}));
    for (const auto& declaration : declared) {
        METIER_ASSIGN(const auto added,
                      declaration.node_class == opcua::NodeClass::method
                          ? nodes.addMethod({.node = specOf(controller, declaration)})
                          : addVariable(nodes, controller, declaration));
        METIER_TRY(shareProperties(nodes, added, declaration.target));
    }
    return {};
}

Result<void> addLock(AddressSpace& nodes, const NodeId& controller) {
    METIER_ASSIGN(const auto di, nodes.namespaceIndex(kDiUri));
    const opcua::ObjectSpec lock{.node = {.parent = controller,
                                          .browse_name = {di, "Lock"},
                                          .description = {"en", "Used to lock the controller."}},
                                 .type = NodeId(di, kLockingServicesType)};
    return nodes.addObject(lock, opcua::MethodNodes::own).map([](const NodeId& /*lock*/) {});
}

}  // namespace

Result<NodeId> makeSkillController(AddressSpace& nodes, const NodeId& controller) {
    METIER_ASSIGN(const auto device, nodes.namespaceIndex(kDeviceUri));
    METIER_ASSIGN(const auto metier, nodes.namespaceIndex(kMetierUri));
    const NodeId lease(metier, kIControlLeaseType);
    for (const auto& interface : {NodeId(device, kISkillControllerType), lease}) {
        METIER_TRY(nodes.addReference(controller, opcua::ids::kHasInterface, interface));
    }
    METIER_TRY(addLease(nodes, controller, lease));
    METIER_TRY(addLock(nodes, controller));
    return nodes.addObject({.node = {.parent = controller,
                                     .browse_name = {device, "Skills"},
                                     .description = {"en", "The skills of the controller."}}});
}

Result<SkillController> publishSkillController(AddressSpace& nodes, const std::string& name,
                                               const std::string& description) {
    METIER_ASSIGN(const auto di, nodes.namespaceIndex(kDiUri));
    METIER_ASSIGN(auto controller,
                  nodes.addObject({.node = {.id = NodeId(kOwnNamespace, name),
                                            .parent = NodeId(di, kDeviceSetId),
                                            .browse_name = {kOwnNamespace, name},
                                            .description = {"en", description}},
                                   .event_notifier = opcua::EventNotifier::subscribable}));
    METIER_TRY(nodes.addReference(opcua::ids::kServer, opcua::ids::kHasNotifier, controller));
    METIER_ASSIGN(auto skills, makeSkillController(nodes, controller));
    return SkillController{std::move(controller), std::move(skills)};
}

Result<SkillController> findSkillController(const opcua::AddressSpace& nodes) {
    METIER_ASSIGN(const auto di, nodes.namespaceIndex(kDiUri));
    METIER_ASSIGN(const auto device, nodes.namespaceIndex(kDeviceUri));
    METIER_ASSIGN(const auto objects, nodes.browse(NodeId(di, kDeviceSetId)));
    for (const auto& object : objects) {
        if (auto skills = nodes.find(object.target, {device, "Skills"})) {
            return SkillController{object.target, std::move(*skills)};
        }
    }
    return fail(Errc::not_found, "no object below DeviceSet has skills");
}

}  // namespace metier::opcua_skill
