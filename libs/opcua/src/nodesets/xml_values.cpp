#include "nodesets/xml_values.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <sstream>
#include <vector>

#include "metier/base/text.hpp"
#include "metier/opcua/text.hpp"
#include "nodesets/xml_scalars.hpp"

namespace metier::opcua {

namespace {

constexpr int kDeepestNesting = 64;
constexpr std::string_view kListPrefix = "ListOf";

/// A Result of a text of this element.
template <typename T>
tl::expected<T, Misread> at(const pugi::xml_node& element, Result<T> result) {
    return result ? tl::expected<T, Misread>(*std::move(result))
                  : misread(element, result.error().message);
}

std::vector<pugi::xml_node> elementsOf(const pugi::xml_node& parent) {
    std::vector<pugi::xml_node> elements;
    for (const auto& child : parent.children()) {
        if (child.type() == pugi::node_element) {
            elements.push_back(child);
        }
    }
    return elements;
}

pugi::xml_node firstElement(const pugi::xml_node& parent) {
    return parent.find_child(
        [](const pugi::xml_node& child) { return child.type() == pugi::node_element; });
}

/// The built-in type of that name; null if there is none.
const UA_DataType* builtInNamed(std::string_view name) {
    for (std::size_t i = 0; i <= UA_DATATYPEKIND_DIAGNOSTICINFO; ++i) {
        if (name == UA_TYPES[i].typeName) {
            return &UA_TYPES[i];
        }
    }
    return nullptr;
}

std::string xmlOf(const pugi::xml_node& element) {
    std::ostringstream text;
    element.print(text, "", pugi::format_raw);
    return text.str();
}

/// Names of fields begin with a capital letter in XML, as they please in definitions.
bool sameField(std::string_view element, std::string_view member) {
    return element.size() == member.size() && !element.empty() &&
           inLowerCase(element.substr(0, 1)) == inLowerCase(member.substr(0, 1)) &&
           element.substr(1) == member.substr(1);
}

struct Field {
    std::size_t index;
    std::size_t offset;  ///< from the start of the structure [byte]
};

std::optional<Field> fieldNamed(const UA_DataType& type, std::string_view name) {
    std::size_t end = 0;
    for (std::size_t i = 0; i < type.membersSize; ++i) {
        const auto& member = type.members[i];
        const auto offset = end + member.padding;
        if (sameField(name, member.memberName)) {
            return Field{i, offset};
        }
        // All fields of a union are at one place.
        end = type.typeKind == UA_DATATYPEKIND_UNION ? 0 : offset + sizeOf(member);
    }
    return std::nullopt;
}

Read readBytes(const pugi::xml_node& element, UA_ByteString& target) {
    std::string text = element.child_value();
    std::erase_if(text, [](char each) { return kBlanks.find(each) != std::string_view::npos; });
    const UA_String view = viewOf(text);
    if (!text.empty() && UA_ByteString_fromBase64(&target, &view) != UA_STATUSCODE_GOOD) {
        return misread(element, "not Base64");
    }
    return {};
}

/// Memory for elements, all zero; the variant owns it.
void* allocate(UA_Variant& target, const UA_DataType& type, std::size_t size) {
    UA_Variant_setArray(&target, checkAllocated(UA_Array_new(size, &type)), size, &type);
    return target.data;
}

void* allocate(UA_Variant& target, const UA_DataType& type) {
    UA_Variant_setScalar(&target, checkAllocated(UA_new(&type)), &type);
    return target.data;
}

std::byte* elementAt(void* array, std::size_t index, const UA_DataType& type) {
    return static_cast<std::byte*>(array) + index * type.memSize;
}

}  // namespace

Read XmlValues::variant(const pugi::xml_node& value, const NodeId& data_type,
                        UA_Variant& target) const {
    const auto element = firstElement(value);
    return element.empty() ? Read() : content(element, data_type, target);
}

Read XmlValues::content(const pugi::xml_node& element, const NodeId& data_type,
                        UA_Variant& target) const {
    const auto name = localName(element);
    if (name == "Matrix") {
        return matrix(element, data_type, target);
    }
    return name.starts_with(kListPrefix) ? list(element, data_type, target)
                                         : scalar(element, target);
}

Read XmlValues::scalar(const pugi::xml_node& element, UA_Variant& target) const {
    const auto* type = builtInNamed(localName(element));
    if (type == nullptr) {
        return misread(element, fmt::format("{} is no built-in type", sanitise(element.name())));
    }
    if (type->typeKind != UA_DATATYPEKIND_EXTENSIONOBJECT) {
        return decode(element, *type, allocate(target, *type));
    }
    METIER_ASSIGN(const auto inner, contentOf(element));
    if (inner.type == nullptr) {
        return decode(element, *type, allocate(target, *type));
    }
    return decode(inner.body, *inner.type, allocate(target, *inner.type));
}

Read XmlValues::list(const pugi::xml_node& element, const NodeId& data_type,
                     UA_Variant& target) const {
    const auto* type = builtInNamed(localName(element).substr(kListPrefix.size()));
    if (type == nullptr) {
        return misread(element,
                       fmt::format("{} is no list of a built-in type", sanitise(element.name())));
    }
    if (type->typeKind == UA_DATATYPEKIND_EXTENSIONOBJECT) {
        return structures(element, data_type, target);
    }
    const auto all = elementsOf(element);
    auto* const array = allocate(target, *type, all.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
        METIER_TRY(decode(all[i], *type, elementAt(array, i, *type)));
    }
    return {};
}

/// An array of one structure has its type; of several ones, or unknown ones, it is an array of
/// ExtensionObjects.
Read XmlValues::structures(const pugi::xml_node& element, const NodeId& data_type,
                           UA_Variant& target) const {
    const auto all = elementsOf(element);
    std::vector<Content> contents;
    for (const auto& each : all) {
        METIER_ASSIGN(auto inner, contentOf(each));
        contents.push_back(inner);
    }
    const auto* type = contents.empty() ? types_.find(data_type) : contents.front().type;
    const bool of_one_type = std::all_of(contents.begin(), contents.end(), [&](const auto& each) {
        return each.type == type && each.type != nullptr;
    });
    if (type == nullptr || !of_one_type || !isStructured(*type)) {
        type = &UA_TYPES[UA_TYPES_EXTENSIONOBJECT];
    }
    auto* const array = allocate(target, *type, all.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
        const auto& source = isStructured(*type) ? contents[i].body : all[i];
        METIER_TRY(decode(source, *type, elementAt(array, i, *type)));
    }
    return {};
}

Read XmlValues::matrix(const pugi::xml_node& element, const NodeId& data_type,
                       UA_Variant& target) const {
    const auto elements = childNamed(element, "Elements");
    const auto all = elementsOf(elements);
    std::vector<UA_UInt32> dimensions;
    std::size_t size = 1;
    for (const auto& each : elementsOf(childNamed(element, "Dimensions"))) {
        auto& length = dimensions.emplace_back();
        METIER_TRY(decode(each, UA_TYPES[UA_TYPES_UINT32], &length));
        // No product of lengths is larger than a number can be.
        size = std::min(size, all.size() + 1) * length;
    }
    if (dimensions.empty() || all.size() != size || all.empty()) {
        return misread(element,
                       fmt::format("{} elements, which do not fit to its dimensions", all.size()));
    }
    const auto* type = builtInNamed(localName(all.front()));
    if (type == nullptr) {
        return misread(all.front(),
                       fmt::format("{} is no built-in type", sanitise(all.front().name())));
    }
    if (type->typeKind == UA_DATATYPEKIND_EXTENSIONOBJECT) {
        METIER_TRY(structures(elements, data_type, target));
    } else {
        auto* const array = allocate(target, *type, all.size());
        for (std::size_t i = 0; i < all.size(); ++i) {
            METIER_TRY(decode(all[i], *type, elementAt(array, i, *type)));
        }
    }
    target.arrayDimensions = static_cast<UA_UInt32*>(
        checkAllocated(UA_Array_new(dimensions.size(), &UA_TYPES[UA_TYPES_UINT32])));
    target.arrayDimensionsSize = dimensions.size();
    std::copy(dimensions.begin(), dimensions.end(), target.arrayDimensions);
    return {};
}

Read XmlValues::decode(const pugi::xml_node& element, const UA_DataType& type, void* target) const {
    if (depth_ >= kDeepestNesting) {
        return misread(element, fmt::format("nested more than {} times", kDeepestNesting));
    }
    ++depth_;
    auto read =
        isStructured(type) ? structure(element, type, target) : builtIn(element, type, target);
    --depth_;
    return read;
}

Read XmlValues::builtIn(const pugi::xml_node& element, const UA_DataType& type,
                        void* target) const {
    const std::string_view text = element.child_value();
    switch (type.typeKind) {
        case UA_DATATYPEKIND_BOOLEAN: {
            const auto truth = booleanIn(text);
            *static_cast<UA_Boolean*>(target) = truth.value_or(false);
            return truth ? Read()
                         : misread(element,
                                   fmt::format("'{}' is neither true nor false", sanitise(text)));
        }
        case UA_DATATYPEKIND_ENUM: {
            const auto number = enumerationIn(text);
            *static_cast<UA_Int32*>(target) = number.value_or(0);
            return number ? Read()
                          : misread(element, fmt::format("'{}' is no number of an "
                                                         "enumeration",
                                                         sanitise(text)));
        }
        case UA_DATATYPEKIND_STRING:
            toNative(text, *static_cast<UA_String*>(target));
            return {};
        case UA_DATATYPEKIND_XMLELEMENT:
            toNative(xmlOf(firstElement(element)), *static_cast<UA_String*>(target));
            return {};
        case UA_DATATYPEKIND_BYTESTRING:
            return readBytes(element, *static_cast<UA_ByteString*>(target));
        case UA_DATATYPEKIND_DATETIME: {
            const auto time = dateTimeIn(text);
            *static_cast<UA_DateTime*>(target) = time.value_or(0);
            return time ? Read()
                        : misread(element, fmt::format("'{}' is no time such as "
                                                       "2024-05-01T00:00:00Z",
                                                       sanitise(text)));
        }
        default:
            break;
    }
    if (type.typeKind <= UA_DATATYPEKIND_DOUBLE) {
        auto why = readNumber(text, type, target);
        return why ? misread(element, *std::move(why)) : Read();
    }
    return named(element, type, target);
}

/// Built-in types that are made of named elements.
Read XmlValues::named(const pugi::xml_node& element, const UA_DataType& type, void* target) const {
    const auto text = [&](std::string_view name) {
        return std::string_view(childNamed(element, name).child_value());
    };
    switch (type.typeKind) {
        case UA_DATATYPEKIND_NODEID:
        case UA_DATATYPEKIND_EXPANDEDNODEID: {
            const auto identifier = trimmed(text("Identifier"));
            METIER_ASSIGN(const auto id, at(element, identifier.empty() ? Result<NodeId>(NodeId())
                                                                        : ids_.nodeId(identifier)));
            // An ExpandedNodeId begins with a NodeId, and the rest of it stays zero.
            toNative(id, *static_cast<UA_NodeId*>(target));
            return {};
        }
        case UA_DATATYPEKIND_QUALIFIEDNAME: {
            const auto number = trimmed(text("NamespaceIndex"));
            const auto of_file = number.empty() ? 0U : numberIn<std::uint32_t>(number);
            METIER_ASSIGN(const auto index, at(element, ids_.index(of_file.value_or(UINT32_MAX))));
            toNative(QualifiedName{index, std::string(text("Name"))},
                     *static_cast<UA_QualifiedName*>(target));
            return {};
        }
        case UA_DATATYPEKIND_LOCALIZEDTEXT:
            toNative(LocalizedText{std::string(text("Locale")), std::string(text("Text"))},
                     *static_cast<UA_LocalizedText*>(target));
            return {};
        case UA_DATATYPEKIND_GUID:
            return UA_Guid_parse(static_cast<UA_Guid*>(target), viewOf(trimmed(text("String")))) ==
                           UA_STATUSCODE_GOOD
                       ? Read()
                       : misread(element, "no Guid");
        case UA_DATATYPEKIND_STATUSCODE: {
            auto why = readNumber(text("Code"), UA_TYPES[UA_TYPES_UINT32], target);
            return why ? misread(element, *std::move(why)) : Read();
        }
        case UA_DATATYPEKIND_VARIANT:
            return variant(childNamed(element, "Value"), {}, *static_cast<UA_Variant*>(target));
        case UA_DATATYPEKIND_EXTENSIONOBJECT:
            return extensionObject(element, *static_cast<UA_ExtensionObject*>(target));
        default:
            return misread(element, fmt::format("a {} cannot be read", type.typeName));
    }
}

tl::expected<XmlValues::Content, Misread> XmlValues::contentOf(
    const pugi::xml_node& element) const {
    Content inner;
    const auto type_id = childNamed(element, "TypeId");
    const auto identifier = textIn(childNamed(type_id, "Identifier"));
    inner.body = firstElement(childNamed(element, "Body"));
    if (identifier.empty() || inner.body.empty()) {
        return inner;
    }
    METIER_ASSIGN(inner.id, at(type_id, ids_.nodeId(identifier)));
    const auto* type = types_.find(type_of_(inner.id));
    const bool is_xml = localName(inner.body) != "ByteString";
    inner.type = is_xml && type != nullptr && isStructured(*type) ? type : nullptr;
    return inner;
}

Read XmlValues::extensionObject(const pugi::xml_node& element, UA_ExtensionObject& target) const {
    METIER_ASSIGN(const auto inner, contentOf(element));
    if (inner.body.empty()) {
        return {};
    }
    if (inner.type != nullptr) {
        void* const data = checkAllocated(UA_new(inner.type));
        UA_ExtensionObject_setValue(&target, data, inner.type);
        return decode(inner.body, *inner.type, data);
    }
    const bool binary = localName(inner.body) == "ByteString";
    target.encoding =
        binary ? UA_EXTENSIONOBJECT_ENCODED_BYTESTRING : UA_EXTENSIONOBJECT_ENCODED_XML;
    auto& encoded = target.content.encoded;
    toNative(inner.id, encoded.typeId);
    if (binary) {
        return readBytes(inner.body, encoded.body);
    }
    toNative(xmlOf(inner.body), encoded.body);
    return {};
}

Read XmlValues::structure(const pugi::xml_node& element, const UA_DataType& type,
                          void* target) const {
    for (const auto& child : elementsOf(element)) {
        if (localName(child) == "SwitchField" || localName(child) == "EncodingMask") {
            continue;  // what they say is in the other elements, too
        }
        const auto field = fieldNamed(type, localName(child));
        if (!field) {
            return misread(child, fmt::format("{} has no field {}", type.typeName,
                                              sanitise(localName(child))));
        }
        if (type.typeKind == UA_DATATYPEKIND_UNION) {
            auto& chosen = *static_cast<UA_UInt32*>(target);
            if (chosen != 0) {
                return misread(child, "a second field of a union");
            }
            chosen = static_cast<UA_UInt32>(field->index + 1);
        }
        METIER_TRY(member(child, type.members[field->index],
                          static_cast<std::byte*>(target) + field->offset));
    }
    return {};
}

Read XmlValues::elements(const pugi::xml_node& element, const UA_DataType& type, void*& target,
                         std::size_t& size) const {
    const auto all = elementsOf(element);
    if (target != nullptr) {
        return misread(element, "the field is set twice");
    }
    target = checkAllocated(UA_Array_new(all.size(), &type));
    size = all.size();
    for (std::size_t i = 0; i < all.size(); ++i) {
        METIER_TRY(decode(all[i], type, elementAt(target, i, type)));
    }
    return {};
}

Read XmlValues::member(const pugi::xml_node& element, const UA_DataTypeMember& member,
                       std::byte* target) const {
    const auto& type = *member.memberType;
    if (member.isArray) {
        // A length, and a pointer to the elements: the stack's layout of an array.
        auto& size = *reinterpret_cast<std::size_t*>(target);
        auto& array = *reinterpret_cast<void**>(target + sizeof(std::size_t));
        return elements(element, type, array, size);
    }
    if (!member.isOptional) {
        UA_clear(target, &type);  // a field that is there twice
        return decode(element, type, target);
    }
    auto& pointer = *reinterpret_cast<void**>(target);
    if (pointer != nullptr) {
        return misread(element, "the field is set twice");
    }
    pointer = checkAllocated(UA_new(&type));
    return decode(element, type, pointer);
}

}  // namespace metier::opcua
