#include "common/convert.hpp"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <limits>

#include "metier/base/overloaded.hpp"

namespace metier::opcua {

namespace {

using Ticks = std::chrono::duration<std::int64_t, std::ratio<1, 10'000'000>>;

// The stack's structs have no const pointers; what it is given through a view it only reads.
UA_Byte* stackPointer(const void* data) noexcept {
    return static_cast<UA_Byte*>(const_cast<void*>(data));  // NOLINT(*-const-cast)
}

}  // namespace

std::string_view bytesOf(const UA_ByteString& bytes) noexcept {
    return {reinterpret_cast<const char*>(bytes.data), bytes.length};
}

UA_String viewOf(std::string_view text) noexcept {
    return UA_String{text.size(), stackPointer(text.data())};
}

UA_NodeId viewOf(const NodeId& id) noexcept {
    UA_NodeId native{};
    native.namespaceIndex = id.namespaceIndex();
    std::visit(overloaded{[&](std::uint32_t number) {
                              native.identifierType = UA_NODEIDTYPE_NUMERIC;
                              native.identifier.numeric = number;
                          },
                          [&](const std::string& text) {
                              native.identifierType = UA_NODEIDTYPE_STRING;
                              native.identifier.string = viewOf(text);
                          },
                          [&](const Guid& guid) {
                              native.identifierType = UA_NODEIDTYPE_GUID;
                              toNative(guid, native.identifier.guid);
                          },
                          [&](const ByteString& bytes) {
                              native.identifierType = UA_NODEIDTYPE_BYTESTRING;
                              native.identifier.byteString = {bytes.bytes.size(),
                                                              stackPointer(bytes.bytes.data())};
                          }},
               id.identifier());
    return native;
}

UA_QualifiedName viewOf(const QualifiedName& name) noexcept {
    return {name.namespace_index, viewOf(name.name)};
}

UA_LocalizedText viewOf(const LocalizedText& text) noexcept {
    return {viewOf(text.locale), viewOf(text.text)};
}

std::string textOf(std::span<const QualifiedName> path) {
    std::string text;
    for (const auto& name : path) {
        text += (text.empty() ? "" : "/") + name.toString();
    }
    return text;
}

std::string textFrom(const UA_String& text) {
    if (text.length == 0) {
        return {};
    }
    return {reinterpret_cast<const char*>(text.data), text.length};
}

UtcTime timeFrom(UA_DateTime time) noexcept {
    using std::chrono::duration_cast;
    // Compared before the epoch is taken away: a message may hold any 64 bits.
    constexpr auto kEarliest =
        duration_cast<Ticks>(UtcTime::min().time_since_epoch()).count() + UA_DATETIME_UNIX_EPOCH;
    constexpr auto kLatest =
        duration_cast<Ticks>(UtcTime::max().time_since_epoch()).count() + UA_DATETIME_UNIX_EPOCH;
    if (time <= kEarliest) {
        return UtcTime::min();
    }
    if (time >= kLatest) {
        return UtcTime::max();
    }
    return UtcTime(duration_cast<UtcTime::duration>(Ticks(time - UA_DATETIME_UNIX_EPOCH)));
}

UA_DateTime nativeTime(UtcTime time) noexcept {
    if (time == UtcTime::min()) {
        return 0;
    }
    if (time == UtcTime::max()) {
        return std::numeric_limits<UA_DateTime>::max();
    }
    return std::chrono::floor<Ticks>(time.time_since_epoch()).count() + UA_DATETIME_UNIX_EPOCH;
}

ByteString bytesFrom(const UA_ByteString& bytes) {
    ByteString result;
    if (bytes.length > 0) {
        result.bytes.assign(bytes.data, bytes.data + bytes.length);
    }
    return result;
}

NodeId fromNative(const UA_NodeId& id) {
    switch (id.identifierType) {
        case UA_NODEIDTYPE_STRING:
            return {id.namespaceIndex, textFrom(id.identifier.string)};
        case UA_NODEIDTYPE_GUID:
            return {id.namespaceIndex, fromNative(id.identifier.guid)};
        case UA_NODEIDTYPE_BYTESTRING:
            return {id.namespaceIndex, bytesFrom(id.identifier.byteString)};
        default:
            return {id.namespaceIndex, id.identifier.numeric};
    }
}

Guid fromNative(const UA_Guid& guid) noexcept {
    Guid result{guid.data1, guid.data2, guid.data3, {}};
    std::copy(std::begin(guid.data4), std::end(guid.data4), result.data4.begin());
    return result;
}

QualifiedName fromNative(const UA_QualifiedName& name) {
    return {name.namespaceIndex, textFrom(name.name)};
}

LocalizedText fromNative(const UA_LocalizedText& text) {
    return {textFrom(text.locale), textFrom(text.text)};
}

Argument fromNative(const UA_Argument& argument) {
    Argument result{textFrom(argument.name),
                    fromNative(argument.dataType),
                    argument.valueRank,
                    {},
                    fromNative(argument.description)};
    if (argument.arrayDimensionsSize > 0) {
        result.array_dimensions.assign(argument.arrayDimensions,
                                       argument.arrayDimensions + argument.arrayDimensionsSize);
    }
    return result;
}

UA_BrowseDirection nativeOf(BrowseDirection direction) noexcept {
    return direction == BrowseDirection::forward ? UA_BROWSEDIRECTION_FORWARD
                                                 : UA_BROWSEDIRECTION_INVERSE;
}

Reference fromNative(const UA_ReferenceDescription& reference) {
    return {fromNative(reference.referenceTypeId),
            fromNative(reference.nodeId.nodeId),
            fromNative(reference.browseName),
            fromNative(reference.displayName),
            static_cast<NodeClass>(reference.nodeClass),
            fromNative(reference.typeDefinition.nodeId)};
}

DataValue fromNative(const UA_DataValue& value) {
    DataValue result;
    if (value.hasValue) {
        result.value = ValueAccess::copyOf(value.value);
    }
    if (value.hasStatus) {
        result.status = StatusCode(value.status);
    }
    if (value.hasSourceTimestamp) {
        result.source_time = timeFrom(value.sourceTimestamp);
    }
    if (value.hasServerTimestamp) {
        result.server_time = timeFrom(value.serverTimestamp);
    }
    return result;
}

void toNative(std::string_view text, UA_String& target) {
    const UA_String view = viewOf(text);
    checkAllocated(UA_String_copy(&view, &target));
}

void toNative(const NodeId& id, UA_NodeId& target) {
    const UA_NodeId view = viewOf(id);
    checkAllocated(UA_NodeId_copy(&view, &target));
}

void toNative(const Guid& guid, UA_Guid& target) noexcept {
    target = {guid.data1, guid.data2, guid.data3, {}};
    std::copy(guid.data4.begin(), guid.data4.end(), std::begin(target.data4));
}

void toNative(const QualifiedName& name, UA_QualifiedName& target) {
    target.namespaceIndex = name.namespace_index;
    toNative(name.name, target.name);
}

void toNative(const LocalizedText& text, UA_LocalizedText& target) {
    const UA_LocalizedText view = viewOf(text);
    checkAllocated(UA_LocalizedText_copy(&view, &target));
}

void toNative(const Argument& argument, UA_Argument& target) {
    UA_Argument view{};
    view.name = viewOf(argument.name);
    view.dataType = viewOf(argument.data_type);
    view.valueRank = argument.value_rank;
    view.description = viewOf(argument.description);
    view.arrayDimensionsSize = argument.array_dimensions.size();
    std::vector<UA_UInt32> dimensions(argument.array_dimensions);
    view.arrayDimensions = dimensions.data();
    checkAllocated(UA_Argument_copy(&view, &target));
}

void toNative(const DataValue& value, UA_DataValue& target) {
    checkAllocated(UA_Variant_copy(&ValueAccess::native(value.value), &target.value));
    target.hasValue = !value.value.isEmpty();
    target.hasStatus = value.status != status::kGood;
    target.status = value.status.value();
    target.hasSourceTimestamp = value.source_time != UtcTime{};
    target.sourceTimestamp = nativeTime(value.source_time);
    target.hasServerTimestamp = value.server_time != UtcTime{};
    target.serverTimestamp = nativeTime(value.server_time);
}

}  // namespace metier::opcua
