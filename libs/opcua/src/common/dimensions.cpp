#include "common/dimensions.hpp"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <span>

namespace metier::opcua {

namespace {

bool arrayFits(const void* data, std::size_t length, const UA_DataType& type) noexcept {
    const auto* element = static_cast<const std::byte*>(data);
    for (std::size_t i = 0; i < length; ++i, element += type.memSize) {
        if (!dimensionsFit(element, type)) {
            return false;
        }
    }
    return true;
}

bool productIs(std::size_t length, std::span<const UA_UInt32> dimensions) noexcept {
    if (dimensions.empty() || dimensions.front() == 0) {
        return dimensions.empty() || length == 0;
    }
    std::size_t product = 1;
    for (const std::size_t dimension : dimensions) {
        if (dimension == 0 || dimension > length / product) {
            return false;
        }
        product *= dimension;
    }
    return product == length;
}

bool variantFits(const UA_Variant& variant) noexcept {
    if (variant.type == nullptr) {
        return true;
    }
    if (UA_Variant_isScalar(&variant)) {
        return dimensionsFit(variant.data, *variant.type);
    }
    return productIs(variant.arrayLength, {variant.arrayDimensions, variant.arrayDimensionsSize}) &&
           arrayFits(variant.data, variant.arrayLength, *variant.type);
}

bool objectFits(const UA_ExtensionObject& object) noexcept {
    return object.encoding < UA_EXTENSIONOBJECT_DECODED ||
           dimensionsFit(object.content.decoded.data, *object.content.decoded.type);
}

/// Value at `position`; moves `position` past it.
template <typename T>
T taken(const std::byte*& position) noexcept {
    T value;
    std::memcpy(&value, position, sizeof value);
    position += sizeof value;
    return value;
}

/// Checks the value of a structure's member; moves `position` to the next member.
bool memberFits(const std::byte*& position, const UA_DataTypeMember& member) noexcept {
    position += member.padding;
    const auto& type = *member.memberType;
    if (member.isArray) {
        const auto length = taken<std::size_t>(position);
        return arrayFits(taken<const void*>(position), length, type);
    }
    if (member.isOptional) {
        const auto* value = taken<const void*>(position);
        return value == nullptr || dimensionsFit(value, type);
    }
    const auto* value = position;
    position += type.memSize;
    return dimensionsFit(value, type);
}

bool structureFits(const void* data, const UA_DataType& type) noexcept {
    const auto* position = static_cast<const std::byte*>(data);
    const std::span members(type.members, type.membersSize);
    return std::all_of(members.begin(), members.end(), [&](const UA_DataTypeMember& member) {
        return memberFits(position, member);
    });
}

bool unionFits(const void* data, const UA_DataType& type) noexcept {
    const auto selected = *static_cast<const UA_UInt32*>(data);
    if (selected == 0) {
        return true;
    }
    const auto* position = static_cast<const std::byte*>(data);
    return selected <= type.membersSize && memberFits(position, type.members[selected - 1]);
}

}  // namespace

bool dimensionsFit(const void* data, const UA_DataType& type) noexcept {
    switch (type.typeKind) {
        case UA_DATATYPEKIND_VARIANT:
            return variantFits(*static_cast<const UA_Variant*>(data));
        case UA_DATATYPEKIND_DATAVALUE:
            return variantFits(static_cast<const UA_DataValue*>(data)->value);
        case UA_DATATYPEKIND_EXTENSIONOBJECT:
            return objectFits(*static_cast<const UA_ExtensionObject*>(data));
        case UA_DATATYPEKIND_STRUCTURE:
        case UA_DATATYPEKIND_OPTSTRUCT:
            return structureFits(data, type);
        case UA_DATATYPEKIND_UNION:
            return unionFits(data, type);
        default:
            return true;
    }
}

}  // namespace metier::opcua
