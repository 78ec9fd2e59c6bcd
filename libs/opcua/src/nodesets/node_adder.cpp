#include "nodesets/node_adder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "common/closed_methods.hpp"
#include "common/convert.hpp"
#include "metier/base/text.hpp"
#include "metier/opcua/standard_ids.hpp"
#include "metier/opcua/text.hpp"

namespace metier::opcua {

namespace {

bool isThere(UA_Server* server, const NodeId& id) {
    void* context = nullptr;
    return UA_Server_getNodeContext(server, viewOf(id), &context) == UA_STATUSCODE_GOOD;
}

Read refusedUnlessGood(const NodeElement& node, UA_StatusCode code) {
    return code == UA_STATUSCODE_GOOD
               ? Read()
               : misread(node.element, fmt::format("{} is refused: {}", node.name.toString(),
                                                   StatusCode(code).name()));
}

/// View of the first text of several languages.
UA_LocalizedText localizedText(const pugi::xml_node& element) {
    return {viewOf(element.attribute("Locale").value()), viewOf(element.child_value())};
}

/// "2,3"; a length that is not known is 0.
std::vector<UA_UInt32> dimensionsIn(std::string_view text, std::int32_t rank) {
    std::vector<UA_UInt32> dimensions;
    for (const auto part : split(text, ',')) {
        dimensions.push_back(numberIn<UA_UInt32>(trimmed(part)).value_or(0));
    }
    if (dimensions.empty() && rank > 0) {
        dimensions.resize(static_cast<std::size_t>(rank));
    }
    return dimensions;
}

/// Whether a scalar or a list is where it may be. The number of dimensions is not compared:
/// official NodeSets have lists of one dimension where they declare two.
bool fitsRank(const UA_Variant& value, std::int32_t rank) {
    const bool scalar = UA_Variant_isScalar(&value);
    return scalar ? rank < UA_VALUERANK_ONE_OR_MORE_DIMENSIONS : rank != UA_VALUERANK_SCALAR;
}

std::string shapeText(const UA_Variant& value) {
    return fmt::format("{}{}", value.type->typeName,
                       UA_Variant_isScalar(&value) ? "" : fmt::format("[{}]", value.arrayLength));
}

}  // namespace

template <typename Attributes>
Attributes NodeAdder::described(const NodeElement& node, Attributes attributes) const {
    const auto display_name = childNamed(node.element, "DisplayName");
    attributes.displayName = display_name.empty() ? UA_LocalizedText{{}, viewOf(node.name.name)}
                                                  : localizedText(display_name);
    attributes.description = localizedText(childNamed(node.element, "Description"));
    return attributes;
}

template <typename Attributes>
Read NodeAdder::begin(const NodeElement& node, const Attributes& attributes,
                      std::size_t attributes_type) const {
    auto* server = context_.server;
    if (!node.parent.isNull() && !isThere(server, node.parent)) {
        return misread(node.element, fmt::format("no parent {}", node.parent.toString()));
    }
    if (!node.type_definition.isNull() && !isThere(server, node.type_definition)) {
        return misread(node.element, fmt::format("no type {}", node.type_definition.toString()));
    }
    if (isThere(server, node.id)) {
        return misread(node.element, "a node of that NodeId is there before");
    }
    const auto code = UA_Server_addNode_begin(
        server, node.node_class, viewOf(node.id), viewOf(node.parent),
        viewOf(node.parent_reference), viewOf(node.name), viewOf(node.type_definition), &attributes,
        &UA_TYPES[attributes_type], nullptr, nullptr);
    return refusedUnlessGood(node, code);
}

Read NodeAdder::finish(const NodeElement& node) const {
    return refusedUnlessGood(node, UA_Server_addNode_finish(context_.server, viewOf(node.id)));
}

template <typename Attributes>
Read NodeAdder::readShape(const NodeElement& node, Attributes& attributes) const {
    const auto data_type =
        context_.ids.nodeId(node.element.attribute("DataType").as_string("i=24"));
    if (!data_type) {
        return misread(node.element, "DataType: " + data_type.error().message);
    }
    if (!isThere(context_.server, *data_type)) {
        return misread(node.element, fmt::format("no data type {}", data_type->toString()));
    }
    toNative(*data_type, attributes.dataType);
    attributes.valueRank = node.element.attribute("ValueRank").as_int(UA_VALUERANK_SCALAR);
    const auto dimensions =
        dimensionsIn(node.element.attribute("ArrayDimensions").value(), attributes.valueRank);
    attributes.arrayDimensions = static_cast<UA_UInt32*>(
        checkAllocated(UA_Array_new(dimensions.size(), &UA_TYPES[UA_TYPES_UINT32])));
    attributes.arrayDimensionsSize = dimensions.size();
    std::copy(dimensions.begin(), dimensions.end(), attributes.arrayDimensions);
    const auto value = childNamed(node.element, "Value");
    METIER_TRY(context_.values.variant(value, *data_type, attributes.value));
    if (attributes.valueRank == UA_VALUERANK_ONE_DIMENSION &&
        UA_Variant_isScalar(&attributes.value)) {
        // So in the official NodeSet of IO-Link: an array of one element has the same memory.
        attributes.value.arrayLength = 1;
    }
    return checkValue(node, attributes.value, *data_type, attributes.valueRank);
}

bool NodeAdder::holds(const NodeId& data_type, const UA_DataType& type) const {
    const auto held = fromNative(type.typeId);
    return data_type == ids::kBaseDataType || context_.tree.isA(held, data_type) ||
           // A name for a built-in type, such as Duration.
           (held.namespaceIndex() == 0 && context_.tree.isA(data_type, held)) ||
           (held == ids::kInt32 && context_.tree.isA(data_type, ids::kEnumeration)) ||
           (held == ids::kStructure && context_.tree.isA(data_type, ids::kStructure));
}

Read NodeAdder::checkValue(const NodeElement& node, const UA_Variant& value,
                           const NodeId& data_type, std::int32_t rank) const {
    if (UA_Variant_isEmpty(&value)) {
        return {};
    }
    const auto element = childNamed(node.element, "Value");
    if (!holds(data_type, *value.type)) {
        return misread(element, fmt::format("a {} is no value of the data type {}",
                                            shapeText(value), data_type.toString()));
    }
    return fitsRank(value, rank) ? Read()
                                 : misread(element, fmt::format("a {} does not have ValueRank {}",
                                                                shapeText(value), rank));
}

template <typename Attributes>
Read NodeAdder::addValued(const NodeElement& node, const Attributes& preset,
                          std::size_t attributes_type) const {
    Owned<Attributes> attributes(preset, UA_TYPES[attributes_type]);
    METIER_TRY(readShape(node, *attributes));
    // These views are not the attributes' own: they must not be cleared with them.
    auto borrowed = described(node, *attributes);
    return begin(node, borrowed, attributes_type);
}

Read NodeAdder::addVariable(const NodeElement& node) const {
    auto preset = UA_VariableAttributes_default;
    const auto level = node.element.attribute("AccessLevel").as_uint(UA_ACCESSLEVELMASK_READ);
    preset.accessLevel = static_cast<UA_Byte>(level & 0xFFU);
    preset.userAccessLevel = preset.accessLevel;
    preset.minimumSamplingInterval =
        node.element.attribute("MinimumSamplingInterval").as_double(0.0);
    METIER_TRY(addValued(node, preset, UA_TYPES_VARIABLEATTRIBUTES));
    if (!node.is_instance || !childNamed(node.element, "Value").empty()) {
        return {};
    }
    UA_DataValue none{};
    none.hasStatus = true;
    none.status = UA_STATUSCODE_BADWAITINGFORINITIALDATA;
    UA_Server_writeDataValue(context_.server, viewOf(node.id), none);
    return {};
}

Read NodeAdder::add(const NodeElement& node) const {
    const bool is_abstract = node.element.attribute("IsAbstract").as_bool(false);
    const auto notifier =
        static_cast<UA_Byte>(node.element.attribute("EventNotifier").as_uint(0) & 0xFFU);
    switch (node.node_class) {
        case UA_NODECLASS_OBJECT: {
            auto attributes = described(node, UA_ObjectAttributes_default);
            attributes.eventNotifier = notifier;
            return begin(node, attributes, UA_TYPES_OBJECTATTRIBUTES);
        }
        case UA_NODECLASS_VARIABLE:
            return addVariable(node);
        case UA_NODECLASS_METHOD: {
            // Nobody may call it until a program gives it work.
            const auto attributes = described(node, UA_MethodAttributes_default);
            METIER_TRY(begin(node, attributes, UA_TYPES_METHODATTRIBUTES));
            return refusedUnlessGood(node, closeMethod(context_.server, viewOf(node.id)));
        }
        case UA_NODECLASS_OBJECTTYPE: {
            auto attributes = described(node, UA_ObjectTypeAttributes_default);
            attributes.isAbstract = is_abstract;
            return begin(node, attributes, UA_TYPES_OBJECTTYPEATTRIBUTES);
        }
        case UA_NODECLASS_VARIABLETYPE: {
            auto preset = UA_VariableTypeAttributes_default;
            preset.isAbstract = is_abstract;
            return addValued(node, preset, UA_TYPES_VARIABLETYPEATTRIBUTES);
        }
        case UA_NODECLASS_DATATYPE: {
            auto attributes = described(node, UA_DataTypeAttributes_default);
            attributes.isAbstract = is_abstract;
            return begin(node, attributes, UA_TYPES_DATATYPEATTRIBUTES);
        }
        case UA_NODECLASS_REFERENCETYPE: {
            auto attributes = described(node, UA_ReferenceTypeAttributes_default);
            attributes.isAbstract = is_abstract;
            attributes.symmetric = node.element.attribute("Symmetric").as_bool(false);
            attributes.inverseName = localizedText(childNamed(node.element, "InverseName"));
            METIER_TRY(begin(node, attributes, UA_TYPES_REFERENCETYPEATTRIBUTES));
            // Makes it one of its supertypes in the eyes of the stack.
            return finish(node);
        }
        default: {
            auto attributes = described(node, UA_ViewAttributes_default);
            attributes.eventNotifier = notifier;
            attributes.containsNoLoops = node.element.attribute("ContainsNoLoops").as_bool(false);
            return begin(node, attributes, UA_TYPES_VIEWATTRIBUTES);
        }
    }
}

}  // namespace metier::opcua
