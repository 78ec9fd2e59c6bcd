#include "metier/opcua_skill/skill_controller.hpp"

#include <utility>

#include "model_ids.hpp"

namespace metier::opcua_skill {
namespace {

using opcua::AddressSpace;
using opcua::NodeId;
using opcua::Reference;

constexpr std::uint32_t kDeviceSet = 5001;
constexpr std::uint32_t kISkillControllerType = 15396;
constexpr std::uint32_t kIControlLeaseType = 20056;
constexpr std::uint32_t kLockingServicesType = 6388;
constexpr std::uint16_t kOwnNamespace = 1;

opcua::NodeSpec specOf(const NodeId& parent, const Reference& declaration) {
    opcua::NodeSpec spec;
    spec.parent = parent;
    spec.browse_name = declaration.browse_name;
    return spec;
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
    opcua::VariableSpec spec;
    spec.node = specOf(parent, declaration);
    spec.type = declaration.type_definition;
    spec.data_type = shape.data_type;
    spec.value_rank = shape.value_rank;
    spec.children = opcua::Children::none;
    return nodes.addVariable(spec);
}

/// Adds the nodes that the lease's interface declares to the controller itself.
Result<void> addLease(AddressSpace& nodes, const NodeId& controller, const NodeId& interface) {
    METIER_ASSIGN(const auto declared, nodes.browse(interface, {opcua::ids::kHasComponent}));
    for (const auto& declaration : declared) {
        METIER_ASSIGN(const auto added,
                      declaration.node_class == opcua::NodeClass::method
                          ? nodes.addMethod({specOf(controller, declaration), {}, {}, {}})
                          : addVariable(nodes, controller, declaration));
        METIER_TRY(shareProperties(nodes, added, declaration.target));
    }
    return {};
}

Result<void> addLock(AddressSpace& nodes, const NodeId& controller) {
    METIER_ASSIGN(const auto di, nodes.namespaceIndex(kDiUri));
    opcua::ObjectSpec lock;
    lock.node.parent = controller;
    lock.node.browse_name = {di, "Lock"};
    lock.node.description = {"en", "Used to lock the controller."};
    lock.type = NodeId(di, kLockingServicesType);
    return nodes.addObject(lock, opcua::MethodNodes::own).map([](const NodeId& /*lock*/) {});
}

}  // namespace

Result<NodeId> makeSkillController(AddressSpace& nodes, const NodeId& controller) {
    const auto device = nodes.namespaceIndex(kDeviceUri);
    const auto metier = nodes.namespaceIndex(kMetierUri);
    if (!device || !metier) {
        return fail(device ? metier.error() : device.error());
    }
    const NodeId lease(*metier, kIControlLeaseType);
    for (const auto& interface : {NodeId(*device, kISkillControllerType), lease}) {
        METIER_TRY(nodes.addReference(controller, opcua::ids::kHasInterface, interface));
    }
    METIER_TRY(addLease(nodes, controller, lease));
    METIER_TRY(addLock(nodes, controller));
    opcua::ObjectSpec skills;
    skills.node.parent = controller;
    skills.node.browse_name = {*device, "Skills"};
    skills.node.description = {"en", "The skills of the controller."};
    return nodes.addObject(skills);
}

Result<SkillController> publishSkillController(AddressSpace& nodes, const std::string& name,
                                               const std::string& description) {
    METIER_ASSIGN(const auto di, nodes.namespaceIndex(kDiUri));
    opcua::ObjectSpec spec;
    spec.node.id = NodeId(kOwnNamespace, name);
    spec.node.parent = NodeId(di, kDeviceSet);
    spec.node.browse_name = {kOwnNamespace, name};
    spec.node.description = {"en", description};
    spec.event_notifier = opcua::EventNotifier::subscribable;
    METIER_ASSIGN(auto controller, nodes.addObject(spec));
    METIER_TRY(nodes.addReference(opcua::ids::kServer, opcua::ids::kHasNotifier, controller));
    METIER_ASSIGN(auto skills, makeSkillController(nodes, controller));
    return SkillController{std::move(controller), std::move(skills)};
}

Result<SkillController> findSkillController(const opcua::AddressSpace& nodes) {
    const auto di = nodes.namespaceIndex(kDiUri);
    const auto device = nodes.namespaceIndex(kDeviceUri);
    if (!di || !device) {
        return fail(di ? device.error() : di.error());
    }
    METIER_ASSIGN(const auto objects, nodes.browse(opcua::NodeId(*di, kDeviceSet)));
    for (const auto& object : objects) {
        if (auto skills = nodes.find(object.target, {*device, "Skills"})) {
            return SkillController{object.target, std::move(*skills)};
        }
    }
    return fail(Errc::not_found, "no object below DeviceSet has skills");
}

}  // namespace metier::opcua_skill
