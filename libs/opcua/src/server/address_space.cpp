#include "metier/opcua/address_space.hpp"

#include <fmt/format.h>

#include "common/closed_methods.hpp"
#include "common/convert.hpp"
#include "metier/opcua/text.hpp"
#include "nodesets/nodeset_file.hpp"
#include "server/node_hooks.hpp"
#include "server/server_core.hpp"

namespace metier::opcua {

namespace {

Result<> outcome(UA_StatusCode code, std::string_view doing, const NodeId& id) {
    if (code == UA_STATUSCODE_GOOD) {
        return {};
    }
    return fail(errorFrom(StatusCode(code), fmt::format("{} {}", doing, id.toString())));
}

/// Attributes of a new node for the stack; borrows from the spec.
struct NewNode {
    explicit NewNode(const NodeSpec& spec)
        : id(spec.id.isNull() ? childId(spec.parent, spec.browse_name) : spec.id),
          display_name(spec.display_name.text.empty() ? LocalizedText{"", spec.browse_name.name}
                                                      : spec.display_name),
          parent(viewOf(spec.parent)),
          reference(spec.parent.isNull() ? UA_NODEID_NULL : viewOf(spec.reference)),
          browse_name(viewOf(spec.browse_name)),
          description(viewOf(spec.description)) {}

    template <typename Attributes>
    Attributes describe(Attributes attributes) const {
        attributes.displayName = viewOf(display_name);
        attributes.description = description;
        return attributes;
    }

    NodeId id;
    LocalizedText display_name;
    UA_NodeId parent;
    UA_NodeId reference;
    UA_QualifiedName browse_name;
    UA_LocalizedText description;
};

UA_Byte accessBits(Access access) noexcept {
    // Since 1.4.18 the stack refuses a written SourceTimestamp without this bit.
    constexpr UA_Byte kWrite = UA_ACCESSLEVELMASK_WRITE | UA_ACCESSLEVELMASK_TIMESTAMPWRITE;
    return access == Access::read_write ? UA_ACCESSLEVELMASK_READ | kWrite
                                        : UA_ACCESSLEVELMASK_READ;
}

/// A writable Variable takes the writer's time with the value.
UA_StatusCode allowSourceTime(UA_Server* server, const UA_NodeId& variable) noexcept {
    UA_Byte level = 0;
    const auto code = UA_Server_readAccessLevel(server, variable, &level);
    if (code != UA_STATUSCODE_GOOD || (level & UA_ACCESSLEVELMASK_WRITE) == 0) {
        return code;
    }
    return UA_Server_writeAccessLevel(server, variable, accessBits(Access::read_write));
}

UA_Byte notifierBits(EventNotifier notifier) noexcept {
    return notifier == EventNotifier::subscribable ? UA_EVENTNOTIFIER_SUBSCRIBE_TO_EVENT : 0;
}

/// Adds what the type brings along to a node that was begun.
UA_StatusCode finish(UA_Server* server, UA_StatusCode begun, const NodeId& id, Children children) {
    return begun == UA_STATUSCODE_GOOD && children == Children::mandatory
               ? UA_Server_addNode_finish(server, viewOf(id))
               : begun;
}

UA_StatusCode add(UA_Server* server, const NewNode& node, const VariableSpec& spec) {
    auto attributes = node.describe(UA_VariableAttributes_default);
    std::vector<UA_UInt32> dimensions(spec.array_dimensions);
    attributes.value = ValueAccess::native(spec.value);
    attributes.dataType = viewOf(spec.data_type);
    attributes.valueRank = spec.value_rank;
    attributes.arrayDimensions = dimensions.data();
    attributes.arrayDimensionsSize = dimensions.size();
    attributes.accessLevel = accessBits(spec.access);
    const auto begun =
        UA_Server_addNode_begin(server, UA_NODECLASS_VARIABLE, viewOf(node.id), node.parent,
                                node.reference, node.browse_name, viewOf(spec.type), &attributes,
                                &UA_TYPES[UA_TYPES_VARIABLEATTRIBUTES], nullptr, nullptr);
    return finish(server, begun, node.id, spec.children);
}

/// Adds a Method without arguments and without work.
UA_StatusCode addBareMethod(UA_Server* server, const NewNode& node) {
    const auto attributes = node.describe(UA_MethodAttributes_default);
    return inOrder(
        [&] {
            return UA_Server_addMethodNode(server, viewOf(node.id), node.parent, node.reference,
                                           node.browse_name, attributes, nullptr, 0, nullptr, 0,
                                           nullptr, nullptr, nullptr);
        },
        [&] { return closeMethod(server, viewOf(node.id)); });
}

/// Adds the Property of a Method that describes its arguments; none, if there are none.
/// The stack's own way loses the memory of both NodeIds.
UA_StatusCode addArguments(UA_Server* server, const NodeId& method, const std::string& name,
                           const std::vector<Argument>& arguments) {
    if (arguments.empty()) {
        return UA_STATUSCODE_GOOD;
    }
    const VariableSpec spec{
        .node = {.parent = method, .reference = ids::kHasProperty, .browse_name = {0, name}},
        .type = ids::kPropertyType,
        .data_type = NodeId(0, UA_NS0ID_ARGUMENT),
        .value_rank = UA_VALUERANK_ONE_DIMENSION,
        .array_dimensions = {static_cast<std::uint32_t>(arguments.size())},
        .value = Value::of(arguments)};
    return add(server, NewNode(spec.node), spec);
}

UA_StatusCode addReference(UA_Server* server, const NodeId& source, const NodeId& type,
                           const NodeId& target) {
    return UA_Server_addReference(server, viewOf(source), viewOf(type),
                                  UA_EXPANDEDNODEID_NODEID(viewOf(target)), true);
}

}  // namespace

NodeId childId(const NodeId& parent, const QualifiedName& browse_name) {
    if (parent.namespaceIndex() == 0) {
        return {browse_name.namespace_index, browse_name.name};
    }
    const auto* text = std::get_if<std::string>(&parent.identifier());
    const auto* number = std::get_if<std::uint32_t>(&parent.identifier());
    const std::string prefix = text != nullptr     ? *text
                               : number != nullptr ? std::to_string(*number)
                                                   : parent.toString();
    return {parent.namespaceIndex(), prefix + "." + browse_name.name};
}

Result<std::uint16_t> AddressSpace::namespaceIndex(std::string_view uri) const {
    std::size_t index = 0;
    if (UA_Server_getNamespaceByName(core_.native(), viewOf(uri), &index) != UA_STATUSCODE_GOOD) {
        return fail(Errc::not_found, fmt::format("no namespace '{}'", sanitise(uri)));
    }
    return static_cast<std::uint16_t>(index);
}

Result<NodeId> AddressSpace::addObject(const ObjectSpec& spec, MethodNodes methods) {
    const NewNode node(spec.node);
    auto attributes = node.describe(UA_ObjectAttributes_default);
    attributes.eventNotifier = notifierBits(spec.event_notifier);
    const auto begun =
        UA_Server_addNode_begin(core_.native(), UA_NODECLASS_OBJECT, viewOf(node.id), node.parent,
                                node.reference, node.browse_name, viewOf(spec.type), &attributes,
                                &UA_TYPES[UA_TYPES_OBJECTATTRIBUTES], nullptr, nullptr);
    const auto code = finish(core_.native(), begun, node.id, spec.children);
    core_.structureChanged();
    METIER_TRY(outcome(code, "add Object", node.id));
    if (methods == MethodNodes::own) {
        METIER_TRY(giveOwnMethods(node.id));
    }
    return node.id;
}

Result<> AddressSpace::giveOwnMethods(const NodeId& object) {
    METIER_ASSIGN(const auto components, browse(object, {ids::kHasComponent}));
    for (const auto& component : components) {
        if (component.node_class != NodeClass::method) {
            continue;
        }
        METIER_TRY(copyMethod(object, component));
    }
    return {};
}

Result<> AddressSpace::copyMethod(const NodeId& object, const Reference& method) {
    UA_Server* server = core_.native();
    const UA_NodeId original = viewOf(method.target);
    METIER_ASSIGN(const auto arguments, browse(method.target, {ids::kHasProperty}));
    Owned<UA_LocalizedText> description(UA_TYPES[UA_TYPES_LOCALIZEDTEXT]);
    UA_Server_readDescription(server, original, description.get());
    NodeSpec spec{
        {}, object, method.type, method.browse_name, method.display_name, fromNative(*description)};
    const NewNode node(spec);
    auto code = inOrder(
        [&] {
            return UA_Server_deleteReference(server, node.parent, viewOf(method.type), true,
                                             UA_EXPANDEDNODEID_NODEID(original), true);
        },
        [&] { return addBareMethod(server, node); });
    for (const auto& argument : arguments) {
        code = code != UA_STATUSCODE_GOOD
                   ? code
                   : opcua::addReference(server, node.id, ids::kHasProperty, argument.target);
    }
    return outcome(code, "copy Method", node.id);
}

Result<NodeId> AddressSpace::addVariable(const VariableSpec& spec) {
    const NewNode node(spec.node);
    METIER_TRY(outcome(add(core_.native(), node, spec), "add Variable", node.id));
    return node.id;
}

Result<NodeId> AddressSpace::addMethod(const MethodSpec& spec) {
    const NewNode node(spec.node);
    UA_Server* server = core_.native();
    const auto code =
        inOrder([&] { return addBareMethod(server, node); },
                [&] { return addArguments(server, node.id, "InputArguments", spec.inputs); },
                [&] { return addArguments(server, node.id, "OutputArguments", spec.outputs); });
    METIER_TRY(outcome(code, "add Method", node.id));
    METIER_TRY(setMethod(node.id, spec.handler));
    return node.id;
}

Result<> AddressSpace::addReference(const NodeId& source, const NodeId& type,
                                    const NodeId& target) {
    core_.structureChanged();
    return outcome(opcua::addReference(core_.native(), source, type, target),
                   fmt::format("add reference to {} from", target.toString()), source);
}

Result<> AddressSpace::addNodeset(std::string_view xml, std::string name) {
    core_.structureChanged();
    METIER_ASSIGN(const auto file, NodesetFile::parse(xml, std::move(name)));
    return core_.addNodes(file);
}

Result<> AddressSpace::deleteNode(const NodeId& id) {
    core_.structureChanged();
    return outcome(UA_Server_deleteNode(core_.native(), viewOf(id), true), "delete", id);
}

Result<NodeId> AddressSpace::find(const NodeId& start, std::span<const QualifiedName> path) const {
    if (path.empty()) {
        return fail(Errc::invalid_argument, "an empty path leads nowhere");
    }
    std::vector<UA_QualifiedName> names;
    for (const auto& name : path) {
        names.push_back(viewOf(name));
    }
    Owned<UA_BrowsePathResult> found(UA_Server_browseSimplifiedBrowsePath(
                                         core_.native(), viewOf(start), names.size(), names.data()),
                                     UA_TYPES[UA_TYPES_BROWSEPATHRESULT]);
    if (found->statusCode != UA_STATUSCODE_GOOD || found->targetsSize == 0) {
        return fail(Errc::not_found, fmt::format("no {} below {}", textOf(path), start.toString()));
    }
    return fromNative(found->targets[0].targetId.nodeId);
}

Result<NodeId> AddressSpace::find(const NodeId& start, const QualifiedName& child) const {
    return find(start, std::span(&child, 1));
}

Result<std::vector<Reference>> AddressSpace::browse(const NodeId& id,
                                                    const BrowseFilter& filter) const {
    UA_BrowseDescription description{};
    description.nodeId = viewOf(id);
    description.referenceTypeId = viewOf(filter.type);
    description.includeSubtypes = true;
    description.browseDirection = nativeOf(filter.direction);
    description.resultMask = UA_BROWSERESULTMASK_ALL;
    Owned<UA_BrowseResult> result(UA_Server_browse(core_.native(), 0, &description),
                                  UA_TYPES[UA_TYPES_BROWSERESULT]);
    if (result->statusCode != UA_STATUSCODE_GOOD) {
        return fail(outcome(result->statusCode, "browse", id).error());
    }
    std::vector<Reference> references;
    references.reserve(result->referencesSize);
    for (std::size_t i = 0; i < result->referencesSize; ++i) {
        references.push_back(fromNative(result->references[i]));
    }
    return references;
}

bool AddressSpace::exists(const NodeId& id) const {
    void* context = nullptr;
    return UA_Server_getNodeContext(core_.native(), viewOf(id), &context) == UA_STATUSCODE_GOOD;
}

Result<VariableShape> AddressSpace::shapeOf(const NodeId& variable) const {
    UA_Server* server = core_.native();
    const UA_NodeId id = viewOf(variable);
    VariableShape shape;
    Owned<UA_NodeId> data_type(UA_TYPES[UA_TYPES_NODEID]);
    Owned<UA_Variant> dimensions(UA_TYPES[UA_TYPES_VARIANT]);
    const auto code =
        inOrder([&] { return UA_Server_readDataType(server, id, data_type.get()); },
                [&] { return UA_Server_readValueRank(server, id, &shape.value_rank); },
                [&] { return UA_Server_readArrayDimensions(server, id, dimensions.get()); });
    if (code != UA_STATUSCODE_GOOD) {
        return fail(outcome(code, "read the data type of", variable).error());
    }
    shape.data_type = fromNative(*data_type);
    const auto* sizes = static_cast<const UA_UInt32*>(dimensions->data);
    shape.array_dimensions.assign(sizes, sizes + dimensions->arrayLength);
    return shape;
}

Result<QualifiedName> AddressSpace::browseNameOf(const NodeId& id) const {
    Owned<UA_QualifiedName> name(UA_TYPES[UA_TYPES_QUALIFIEDNAME]);
    const auto code = UA_Server_readBrowseName(core_.native(), viewOf(id), name.get());
    if (code != UA_STATUSCODE_GOOD) {
        return fail(outcome(code, "read the BrowseName of", id).error());
    }
    return fromNative(*name);
}

Result<LocalizedText> AddressSpace::descriptionOf(const NodeId& id) const {
    Owned<UA_LocalizedText> text(UA_TYPES[UA_TYPES_LOCALIZEDTEXT]);
    const auto code = UA_Server_readDescription(core_.native(), viewOf(id), text.get());
    if (code != UA_STATUSCODE_GOOD) {
        return fail(outcome(code, "read the description of", id).error());
    }
    return fromNative(*text);
}

Result<DataValue> AddressSpace::read(const NodeId& variable) const {
    UA_ReadValueId item{};
    item.nodeId = viewOf(variable);
    item.attributeId = UA_ATTRIBUTEID_VALUE;
    Owned<UA_DataValue> value(UA_Server_read(core_.native(), &item, UA_TIMESTAMPSTORETURN_BOTH),
                              UA_TYPES[UA_TYPES_DATAVALUE]);
    const bool absent = value->status == UA_STATUSCODE_BADNODEIDUNKNOWN ||
                        value->status == UA_STATUSCODE_BADATTRIBUTEIDINVALID;
    if (value->hasStatus && absent) {
        return fail(outcome(value->status, "read", variable).error());
    }
    return fromNative(*value);
}

Result<> AddressSpace::write(const NodeId& variable, const Value& value) {
    return outcome(
        UA_Server_writeValue(core_.native(), viewOf(variable), ValueAccess::native(value)),
        fmt::format("write {} to", value.typeName()), variable);
}

Result<> AddressSpace::write(const NodeId& variable, const DataValue& value) {
    UA_DataValue native{};
    native.value = ValueAccess::native(value.value);
    native.hasValue = true;
    native.hasStatus = value.status != status::kGood;
    native.status = value.status.value();
    native.hasSourceTimestamp = value.source_time != UtcTime{};
    native.sourceTimestamp = nativeTime(value.source_time);
    return outcome(UA_Server_writeDataValue(core_.native(), viewOf(variable), native),
                   fmt::format("write {} to", value.value.typeName()), variable);
}

Result<> AddressSpace::setDataSource(const NodeId& variable, DataSource source) {
    UA_Server* server = core_.native();
    const UA_NodeId id = viewOf(variable);
    METIER_ASSIGN(auto hooks, core_.hooks().of(server, variable));
    hooks->work = std::move(source);
    const auto code = inOrder(
        [&] { return UA_Server_setVariableNode_dataSource(server, id, dataSourceCallbacks()); },
        [&] { return allowSourceTime(server, id); });
    return outcome(code, "give a source to", variable);
}

Result<> AddressSpace::setHandler(const NodeId& variable, VariableSlot& slot) {
    UA_Server* server = core_.native();
    const UA_NodeId id = viewOf(variable);
    const auto code =
        inOrder([&] { return UA_Server_setNodeContext(server, id, &slot); },
                [&] { return UA_Server_setVariableNode_dataSource(server, id, slotCallbacks()); },
                // Else the stack drops the time stamps of what is read and written.
                [&] { return UA_Server_setVariableNodeDynamic(server, id, true); },
                [&] { return allowSourceTime(server, id); });
    return outcome(code, "give a handler to", variable);
}

Result<> AddressSpace::setAccess(const NodeId& variable, Access access) {
    return outcome(UA_Server_writeAccessLevel(core_.native(), viewOf(variable), accessBits(access)),
                   "set the access of", variable);
}

Result<> AddressSpace::setMethod(const NodeId& method, MethodHandler handler, MethodEffect effect) {
    UA_Server* server = core_.native();
    METIER_ASSIGN(auto hooks, core_.hooks().of(server, method));
    const bool has_work = static_cast<bool>(handler);
    hooks->methodHooks().handler = std::move(handler);
    hooks->methodHooks().effect = effect;
    return outcome(has_work ? openMethod(server, viewOf(method), callMethod)
                            : closeMethod(server, viewOf(method)),
                   "give work to", method);
}

Result<> AddressSpace::setExecutable(const NodeId& method,
                                     std::function<bool(const Session&)> predicate) {
    METIER_ASSIGN(auto hooks, core_.hooks().of(core_.native(), method));
    hooks->methodHooks().executable = std::move(predicate);
    return {};
}

Result<> AddressSpace::setEventNotifier(const NodeId& object, EventNotifier notifier) {
    return outcome(
        UA_Server_writeEventNotifier(core_.native(), viewOf(object), notifierBits(notifier)),
        "set the event notifier of", object);
}

}  // namespace metier::opcua
