#include "server/enum_properties.hpp"

#include <span>
#include <string_view>
#include <vector>

#include "common/convert.hpp"

namespace metier::opcua {

namespace {

/// Value of a Property of a data type; empty without the Property. The stack (1.4) follows no path
/// that begins at a data type.
Value propertyOf(const AddressSpace& nodes, const NodeId& data_type, std::string_view name) {
    const auto properties = nodes.browse(data_type, {ids::kHasProperty});
    for (const auto& property : properties.value_or(std::vector<Reference>())) {
        if (property.browse_name.namespace_index == 0 && property.browse_name.name == name) {
            const auto read = nodes.read(property.target);
            return read ? read->value : Value();
        }
    }
    return {};
}

/// Elements of an array, or of a scalar, of that type; none if it holds another one.
template <typename Native>
std::span<const Native> elementsOf(const Value& value, const UA_DataType& type) {
    const auto& held = ValueAccess::native(value);
    if (held.type != &type) {
        return {};
    }
    return {static_cast<const Native*>(held.data),
            UA_Variant_isScalar(&held) ? 1 : held.arrayLength};
}

void fill(UA_EnumField& field, UA_Int64 value, const UA_LocalizedText& name) {
    field.value = value;
    checkAllocated(UA_String_copy(&name.text, &field.name));
    checkAllocated(UA_LocalizedText_copy(&name, &field.displayName));
}

void fill(std::span<UA_EnumField> fields, std::span<const UA_LocalizedText> names) {
    for (std::size_t i = 0; i < fields.size(); ++i) {
        fill(fields[i], static_cast<UA_Int64>(i), names[i]);
    }
}

void fill(std::span<UA_EnumField> fields, std::span<const UA_EnumValueType> values) {
    for (std::size_t i = 0; i < fields.size(); ++i) {
        fill(fields[i], values[i].value, values[i].displayName);
        checkAllocated(UA_LocalizedText_copy(&values[i].description, &fields[i].description));
    }
}

void define(const AddressSpace& nodes, const NodeId& data_type, DataTypeStore& store) {
    const auto strings = propertyOf(nodes, data_type, "EnumStrings");
    const auto values = propertyOf(nodes, data_type, "EnumValues");
    const auto names = elementsOf<UA_LocalizedText>(strings, UA_TYPES[UA_TYPES_LOCALIZEDTEXT]);
    const auto numbered = elementsOf<UA_EnumValueType>(values, UA_TYPES[UA_TYPES_ENUMVALUETYPE]);
    if (!numbered.empty()) {
        fill(store.defineEnumeration(data_type, numbered.size()), numbered);
    } else if (!names.empty()) {
        fill(store.defineEnumeration(data_type, names.size()), names);
    }
}

}  // namespace

Result<> defineByProperties(const AddressSpace& nodes, DataTypeStore& store) {
    std::vector<NodeId> types{ids::kEnumeration};
    for (std::size_t next = 0; next < types.size(); ++next) {
        METIER_ASSIGN(const auto below, nodes.browse(types[next], {ids::kHasSubtype}));
        for (const auto& type : below) {
            types.push_back(type.target);
            if (store.enumeration(type.target) == nullptr) {
                define(nodes, type.target, store);
            }
        }
    }
    return {};
}

}  // namespace metier::opcua
