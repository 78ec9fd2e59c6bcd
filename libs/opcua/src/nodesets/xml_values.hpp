#pragma once

#include <functional>
#include <optional>
#include <string>
#include <tl/expected.hpp>
#include <utility>

#include "common/convert.hpp"
#include "nodesets/data_types.hpp"
#include "nodesets/nodeset_ids.hpp"

namespace metier::opcua {

/// A place in a NodeSet file at which no value can be read, and why.
struct Misread {
    pugi::xml_node element;
    std::string why;
};

inline tl::unexpected<Misread> misread(const pugi::xml_node& element, std::string why) {
    return tl::unexpected<Misread>(Misread{element, std::move(why)});
}

/// Success of a reading.
using Read = tl::expected<void, Misread>;

/// Reads values in the XML encoding of OPC UA (OPC 10000-6, 5.3), as they are in NodeSet files.
///
/// Threading: the server's own thread.
class XmlValues {
public:
    /// The data type of an id in an ExtensionObject: that of an encoding, or the data type itself.
    using TypeOfEncoding = std::function<NodeId(const NodeId&)>;

    /// All must outlive this.
    XmlValues(const NodesetIds& ids, const DataTypeBuilder& types, TypeOfEncoding type_of)
        : ids_(ids), types_(types), type_of_(std::move(type_of)) {}

    /// The value in an element `Value`: built-in types, structures, arrays and matrices. A
    /// structure without a description keeps its XML. \param data_type that of the Variable, for
    /// empty lists
    Read variant(const pugi::xml_node& value, const NodeId& data_type, UA_Variant& target) const;

private:
    struct Content {
        const UA_DataType* type = nullptr;  ///< null: not known
        pugi::xml_node body;                ///< the element of the structure
        NodeId id;                          ///< as in the file
    };

    Read content(const pugi::xml_node& element, const NodeId& data_type, UA_Variant& target) const;
    Read scalar(const pugi::xml_node& element, UA_Variant& target) const;
    Read list(const pugi::xml_node& element, const NodeId& data_type, UA_Variant& target) const;
    Read matrix(const pugi::xml_node& element, const NodeId& data_type, UA_Variant& target) const;
    Read structures(const pugi::xml_node& element, const NodeId& data_type,
                    UA_Variant& target) const;
    /// Fills memory that is all zero; whatever the outcome, the caller clears it.
    Read decode(const pugi::xml_node& element, const UA_DataType& type, void* target) const;
    Read elements(const pugi::xml_node& element, const UA_DataType& type, void*& target,
                  std::size_t& size) const;
    Read builtIn(const pugi::xml_node& element, const UA_DataType& type, void* target) const;
    Read named(const pugi::xml_node& element, const UA_DataType& type, void* target) const;
    Read structure(const pugi::xml_node& element, const UA_DataType& type, void* target) const;
    Read member(const pugi::xml_node& element, const UA_DataTypeMember& member,
                std::byte* target) const;
    Read extensionObject(const pugi::xml_node& element, UA_ExtensionObject& target) const;
    tl::expected<Content, Misread> contentOf(const pugi::xml_node& element) const;

    const NodesetIds& ids_;
    const DataTypeBuilder& types_;
    TypeOfEncoding type_of_;
    mutable int depth_ = 0;
};

}  // namespace metier::opcua
