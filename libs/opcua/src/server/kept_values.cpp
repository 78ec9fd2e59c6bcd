#include "server/kept_values.hpp"

#include <open62541/plugin/nodestore.h>

#include <algorithm>
#include <span>
#include <utility>

#include "common/guard.hpp"
#include "server/server_core.hpp"

namespace metier::opcua {

namespace {

const NodeId kAggregates{0, std::uint32_t{UA_NS0ID_AGGREGATES}};

/// Whether the stack itself keeps the value of a Variable that clients may write.
bool isStoredByTheStack(const UA_VariableNode& variable) {
    return (variable.accessLevel & UA_ACCESSLEVELMASK_WRITE) != 0 &&
           variable.valueBackend.backendType == UA_VALUEBACKENDTYPE_NONE &&
           variable.valueSource == UA_VALUESOURCE_DATA &&
           variable.value.data.callback.onRead == nullptr &&
           variable.value.data.callback.onWrite == nullptr;
}

/// The value of a Variable that the stack keeps, as `isStoredByTheStack`; null if it does not.
/// Valid until the node changes.
const UA_DataValue* storedValue(UA_Server* server, const UA_NodeId& id) {
    const auto& store = UA_Server_getConfig(server)->nodestore;
    const UA_Node* node = store.getNode(store.context, &id, UA_NODEATTRIBUTESMASK_ALL,
                                        UA_REFERENCETYPESET_NONE, UA_BROWSEDIRECTION_FORWARD);
    if (node == nullptr) {
        return nullptr;
    }
    const bool stored = node->head.nodeClass == UA_NODECLASS_VARIABLE &&
                        node->head.context == nullptr && isStoredByTheStack(node->variableNode);
    const auto* value = stored ? &node->variableNode.value.data.value : nullptr;
    store.releaseNode(store.context, node);
    return value;
}

/// Whether a node is below a type.
bool isDeclared(const AddressSpace& nodes, const NodeId& node) {
    std::vector<NodeId> open{node};
    for (std::size_t next = 0; next < open.size(); ++next) {
        const auto above = nodes.browse(open[next], {kAggregates, BrowseDirection::inverse});
        for (const auto& parent : above.value_or(std::vector<Reference>())) {
            if (parent.node_class == NodeClass::object_type ||
                parent.node_class == NodeClass::variable_type) {
                return true;
            }
            if (std::find(open.begin(), open.end(), parent.target) == open.end()) {
                open.push_back(parent.target);
            }
        }
    }
    return false;
}

UA_StatusCode readKept(UA_Server* /*server*/, const UA_NodeId* /*session_id*/,
                       void* /*session_context*/, const UA_NodeId* /*id*/, void* context,
                       UA_Boolean /*source_time*/, const UA_NumericRange* range,
                       UA_DataValue* result) noexcept {
    return guarded([&] {
        auto& kept = std::get<KeptValue>(static_cast<NodeHooks*>(context)->work).value;
        return range == nullptr ? UA_DataValue_copy(kept.get(), result)
                                : UA_DataValue_copyVariantRange(kept.get(), result, *range);
    });
}

/// Whether the AccessLevel allows what a client says of its value.
bool allows(UA_Byte level, const UA_DataValue& written) {
    const bool own_status = written.hasStatus && written.status != UA_STATUSCODE_GOOD;
    const bool own_time = (written.hasSourceTimestamp && written.sourceTimestamp != 0) ||
                          (written.hasServerTimestamp && written.serverTimestamp != 0);
    return (!own_status || (level & UA_ACCESSLEVELMASK_STATUSWRITE) != 0) &&
           (!own_time || (level & UA_ACCESSLEVELMASK_TIMESTAMPWRITE) != 0);
}

/// Lengths of an array in its dimensions.
std::span<const UA_UInt32> extentsOf(const UA_Variant& array, const UA_UInt32& length) noexcept {
    return array.arrayDimensionsSize == 0
               ? std::span(&length, 1)
               : std::span(array.arrayDimensions, array.arrayDimensionsSize);
}

/// Whether an array has as many elements as its dimensions say. The stack (1.4.11) compares their
/// product modulo 2^64, and looks for elements by it.
bool fillsItsDimensions(const UA_Variant& value) noexcept {
    const std::span extents(value.arrayDimensions, value.arrayDimensionsSize);
    std::size_t product = 1;
    for (const auto extent : extents) {
        if (extent == 0 || product > value.arrayLength / extent) {
            return value.arrayLength == 0 && extent == 0;
        }
        product *= extent;
    }
    return extents.empty() || product == value.arrayLength;
}

/// Whether a range lies within an array. Of one that does not, the stack (1.4.11) writes what is
/// beyond the end.
bool contains(const UA_Variant& array, const UA_NumericRange& range) noexcept {
    const auto length = static_cast<UA_UInt32>(array.arrayLength);
    const auto extents = extentsOf(array, length);
    const std::span dimensions(range.dimensions, range.dimensionsSize);
    return std::equal(
        dimensions.begin(), dimensions.end(), extents.begin(), extents.end(),
        [](const UA_NumericRangeDimension& part, UA_UInt32 extent) { return part.max < extent; });
}

UA_StatusCode replaceWhole(UA_DataValue& kept, const UA_DataValue& written) {
    if (!fillsItsDimensions(written.value)) {
        return UA_STATUSCODE_BADOUTOFRANGE;
    }
    Owned<UA_DataValue> copy(UA_TYPES[UA_TYPES_DATAVALUE]);
    const auto code = UA_DataValue_copy(&written, copy.get());
    if (code == UA_STATUSCODE_GOOD) {
        std::swap(kept, *copy);
    }
    return code;
}

/// Replaces a part of an array or a text, as the stack does with values of its own.
UA_StatusCode replacePart(UA_DataValue& kept, const UA_DataValue& written,
                          const UA_NumericRange& range) {
    if (!kept.hasValue || !written.hasValue || kept.status != written.status) {
        return UA_STATUSCODE_BADINDEXRANGEINVALID;
    }
    if (kept.value.type == nullptr || kept.value.type != written.value.type) {
        return UA_STATUSCODE_BADTYPEMISMATCH;
    }
    if (!contains(kept.value, range)) {
        return UA_STATUSCODE_BADINDEXRANGENODATA;
    }
    const auto size = UA_Variant_isScalar(&written.value) ? 1 : written.value.arrayLength;
    const auto code = UA_Variant_setRangeCopy(&kept.value, written.value.data, size, range);
    if (code == UA_STATUSCODE_GOOD) {
        kept.hasSourceTimestamp = written.hasSourceTimestamp;
        kept.sourceTimestamp = written.sourceTimestamp;
    }
    return code;
}

UA_StatusCode writeKept(UA_Server* server, const UA_NodeId* /*session_id*/, void* session_context,
                        const UA_NodeId* id, void* context, const UA_NumericRange* range,
                        const UA_DataValue* value) noexcept {
    return guarded([&] {
        const bool by_client = session_context != nullptr;
        UA_Byte level = 0;
        const auto read = UA_Server_readAccessLevel(server, *id, &level);
        if (read != UA_STATUSCODE_GOOD || (by_client && !allows(level, *value))) {
            return read != UA_STATUSCODE_GOOD ? read : UA_STATUSCODE_BADWRITENOTSUPPORTED;
        }
        auto& kept = *std::get<KeptValue>(static_cast<NodeHooks*>(context)->work).value;
        return range == nullptr ? replaceWhole(kept, *value) : replacePart(kept, *value, *range);
    });
}

}  // namespace

Storage keepValueOf(ServerCore& core, const NodeId& variable) {
    UA_Server* server = core.native();
    const UA_NodeId id = viewOf(variable);
    const auto* stored = variable.namespaceIndex() == 0 ? nullptr : storedValue(server, id);
    if (stored == nullptr) {
        return Storage::elsewhere;
    }
    if (isDeclared(core.nodes(), variable)) {
        return Storage::declared;
    }
    const auto hooks = core.hooks().of(server, variable);
    if (!hooks) {
        return Storage::elsewhere;
    }
    checkAllocated(UA_DataValue_copy(stored, (*hooks)->work.emplace<KeptValue>().value.get()));
    // Else the stack drops the time stamps of what is written, and cannot refuse them.
    checkAllocated(UA_Server_setVariableNodeDynamic(server, id, true));
    checkAllocated(UA_Server_setVariableNode_dataSource(server, id, {readKept, writeKept}));
    return Storage::kept;
}

}  // namespace metier::opcua
