#pragma once

// For each type a Value can hold, the stack's type and the way there and back.

#include "common/convert.hpp"

namespace metier::opcua {

template <typename T, std::size_t kType>
struct Same {
    using Type = T;
    static constexpr std::size_t kIndex = kType;
    static void write(const T& value, T& target) noexcept { target = value; }
    static T read(const T& value) noexcept { return value; }
};

template <typename T, typename NativeType, std::size_t kType>
struct Converted {
    using Type = NativeType;
    static constexpr std::size_t kIndex = kType;
    static void write(const T& value, NativeType& target) { toNative(value, target); }
    static T read(const NativeType& value) { return fromNative(value); }
};

/// Native<T>: Type, kIndex in UA_TYPES, write(value, target), read(native).
template <typename T>
struct Native;

template <>
struct Native<bool> : Same<bool, UA_TYPES_BOOLEAN> {};
template <>
struct Native<std::int8_t> : Same<std::int8_t, UA_TYPES_SBYTE> {};
template <>
struct Native<std::uint8_t> : Same<std::uint8_t, UA_TYPES_BYTE> {};
template <>
struct Native<std::int16_t> : Same<std::int16_t, UA_TYPES_INT16> {};
template <>
struct Native<std::uint16_t> : Same<std::uint16_t, UA_TYPES_UINT16> {};
template <>
struct Native<std::int32_t> : Same<std::int32_t, UA_TYPES_INT32> {};
template <>
struct Native<std::uint32_t> : Same<std::uint32_t, UA_TYPES_UINT32> {};
template <>
struct Native<std::int64_t> : Same<std::int64_t, UA_TYPES_INT64> {};
template <>
struct Native<std::uint64_t> : Same<std::uint64_t, UA_TYPES_UINT64> {};
template <>
struct Native<float> : Same<float, UA_TYPES_FLOAT> {};
template <>
struct Native<double> : Same<double, UA_TYPES_DOUBLE> {};
template <>
struct Native<NodeId> : Converted<NodeId, UA_NodeId, UA_TYPES_NODEID> {};
template <>
struct Native<QualifiedName> : Converted<QualifiedName, UA_QualifiedName, UA_TYPES_QUALIFIEDNAME> {
};
template <>
struct Native<LocalizedText> : Converted<LocalizedText, UA_LocalizedText, UA_TYPES_LOCALIZEDTEXT> {
};
template <>
struct Native<Guid> : Converted<Guid, UA_Guid, UA_TYPES_GUID> {};
template <>
struct Native<Argument> : Converted<Argument, UA_Argument, UA_TYPES_ARGUMENT> {};

template <>
struct Native<std::string> {
    using Type = UA_String;
    static constexpr std::size_t kIndex = UA_TYPES_STRING;
    static void write(const std::string& value, UA_String& target) { toNative(value, target); }
    static std::string read(const UA_String& value) { return textFrom(value); }
};

template <>
struct Native<ByteString> {
    using Type = UA_ByteString;
    static constexpr std::size_t kIndex = UA_TYPES_BYTESTRING;
    static void write(const ByteString& value, UA_ByteString& target) {
        checkAllocated(UA_ByteString_allocBuffer(&target, value.bytes.size()));
        std::copy(value.bytes.begin(), value.bytes.end(), target.data);
    }
    static ByteString read(const UA_ByteString& value) { return bytesFrom(value); }
};

template <>
struct Native<UtcTime> {
    using Type = UA_DateTime;
    static constexpr std::size_t kIndex = UA_TYPES_DATETIME;
    static void write(UtcTime value, UA_DateTime& target) noexcept { target = nativeTime(value); }
    static UtcTime read(UA_DateTime value) noexcept { return timeFrom(value); }
};

template <>
struct Native<StatusCode> {
    using Type = UA_StatusCode;
    static constexpr std::size_t kIndex = UA_TYPES_STATUSCODE;
    static void write(StatusCode value, UA_StatusCode& target) noexcept { target = value.value(); }
    static StatusCode read(UA_StatusCode value) noexcept { return StatusCode(value); }
};

template <>
struct Native<Range> {
    using Type = UA_Range;
    static constexpr std::size_t kIndex = UA_TYPES_RANGE;
    static void write(const Range& value, UA_Range& target) noexcept {
        target = {value.low, value.high};
    }
    static Range read(const UA_Range& value) noexcept { return {value.low, value.high}; }
};

template <>
struct Native<EuInformation> {
    using Type = UA_EUInformation;
    static constexpr std::size_t kIndex = UA_TYPES_EUINFORMATION;
    static void write(const EuInformation& value, UA_EUInformation& target) {
        target.unitId = value.unit_id;
        toNative(value.namespace_uri, target.namespaceUri);
        toNative(value.display_name, target.displayName);
        toNative(value.description, target.description);
    }
    static EuInformation read(const UA_EUInformation& value) {
        return {textFrom(value.namespaceUri), value.unitId, fromNative(value.displayName),
                fromNative(value.description)};
    }
};

template <>
struct Native<ThreeDFrame> {
    using Type = UA_ThreeDFrame;
    static constexpr std::size_t kIndex = UA_TYPES_THREEDFRAME;
    static void write(const ThreeDFrame& value, UA_ThreeDFrame& target) noexcept {
        target.cartesianCoordinates = {value.x, value.y, value.z};
        target.orientation = {value.a, value.b, value.c};
    }
    static ThreeDFrame read(const UA_ThreeDFrame& value) noexcept {
        const auto& [x, y, z] = value.cartesianCoordinates;
        const auto& [a, b, c] = value.orientation;
        return {x, y, z, a, b, c};
    }
};

/// Three numbers, whatever their names.
template <typename T, typename NativeType, std::size_t kType>
struct ThreeNumbers {
    using Type = NativeType;
    static constexpr std::size_t kIndex = kType;
    static void write(const T& value, NativeType& target) noexcept {
        const auto& [first, second, third] = value;
        target = {first, second, third};
    }
    static T read(const NativeType& value) noexcept {
        const auto& [first, second, third] = value;
        return {first, second, third};
    }
};

template <>
struct Native<ThreeDCartesianCoordinates>
    : ThreeNumbers<ThreeDCartesianCoordinates, UA_ThreeDCartesianCoordinates,
                   UA_TYPES_THREEDCARTESIANCOORDINATES> {};
template <>
struct Native<ThreeDOrientation>
    : ThreeNumbers<ThreeDOrientation, UA_ThreeDOrientation, UA_TYPES_THREEDORIENTATION> {};
template <>
struct Native<ThreeDVector> : ThreeNumbers<ThreeDVector, UA_ThreeDVector, UA_TYPES_THREEDVECTOR> {};

template <>
struct Native<ProgramDiagnostic> : Converted<ProgramDiagnostic, UA_ProgramDiagnostic2DataType,
                                             UA_TYPES_PROGRAMDIAGNOSTIC2DATATYPE> {};

template <>
struct Native<Value> {
    using Type = UA_Variant;
    static constexpr std::size_t kIndex = UA_TYPES_VARIANT;
    static void write(const Value& value, UA_Variant& target) {
        checkAllocated(UA_Variant_copy(&ValueAccess::native(value), &target));
    }
    static Value read(const UA_Variant& value) { return ValueAccess::copyOf(value); }
};

template <>
struct Native<KeyValue> {
    using Type = UA_KeyValuePair;
    static constexpr std::size_t kIndex = UA_TYPES_KEYVALUEPAIR;
    static void write(const KeyValue& value, UA_KeyValuePair& target) {
        toNative(value.key, target.key);
        Native<Value>::write(value.value, target.value);
    }
    static KeyValue read(const UA_KeyValuePair& value) {
        return {fromNative(value.key), ValueAccess::copyOf(value.value)};
    }
};

/// Fills an array of a structure of the stack, whose old content must not own anything.
template <typename T>
void toNative(const std::vector<T>& values, typename Native<T>::Type*& target, std::size_t& size) {
    const auto& type = UA_TYPES[Native<T>::kIndex];
    target =
        static_cast<typename Native<T>::Type*>(checkAllocated(UA_Array_new(values.size(), &type)));
    size = values.size();
    for (std::size_t i = 0; i < size; ++i) {
        Native<T>::write(values[i], target[i]);
    }
}

/// Copies an array of the stack.
template <typename T>
std::vector<T> vectorFrom(const typename Native<T>::Type* first, std::size_t size) {
    std::vector<T> values;
    values.reserve(size);
    for (std::size_t i = 0; i < size; ++i) {
        values.push_back(Native<T>::read(first[i]));
    }
    return values;
}

}  // namespace metier::opcua
