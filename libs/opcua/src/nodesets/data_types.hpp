#pragma once

#include <open62541/server.h>

#include <deque>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "common/convert.hpp"
#include "metier/opcua/node_id.hpp"
#include "nodesets/nodeset_ids.hpp"
#include "nodesets/type_tree.hpp"

namespace metier::opcua {

/// Data types of one server: structures of its NodeSet files, as the stack describes types, and
/// enumerations, which the stack (1.4) does not describe. Must outlive the server, which keeps
/// pointers into it.
class DataTypeStore {
public:
    DataTypeStore() = default;
    DataTypeStore(const DataTypeStore&) = delete;
    DataTypeStore& operator=(const DataTypeStore&) = delete;

    /// Definition of an enumeration; null if there is none.
    const UA_EnumDefinition* enumeration(const NodeId& data_type) const noexcept;
    /// Empty fields of an enumeration that has no definition yet, for the caller to fill.
    std::span<UA_EnumField> defineEnumeration(const NodeId& data_type, std::size_t fields);

private:
    friend class DataTypeBuilder;
    /// Types of one file; no address in it may change.
    struct Group {
        std::vector<UA_DataType> structures;
        std::deque<UA_DataType> enumerations;
        std::deque<std::vector<UA_DataTypeMember>> members;
        std::deque<std::string> names;
        std::deque<NodeId> ids;
        std::optional<UA_DataTypeArray> array;  ///< the link of the server's chain
    };
    std::deque<Group> groups_;
    std::unordered_map<NodeId, Owned<UA_EnumDefinition>> enumerations_;
};

/// Whether it is a structure, with or without optional fields, or a union.
bool isStructured(const UA_DataType& type) noexcept;
/// Memory of a field in its structure [byte].
std::size_t sizeOf(const UA_DataTypeMember& member) noexcept;

/// A data type of a NodeSet file.
struct DataTypeElement {
    NodeId id;
    NodeId binary_encoding;  ///< null: it has none
    pugi::xml_node element;
};

/// Makes the stack's descriptions of the data types of one NodeSet file and registers them, so that
/// the server and its clients can take values apart, and read DataTypeDefinition.
///
/// Threading: the server's own thread.
class DataTypeBuilder {
public:
    /// \param tree knows the types above those of the file
    DataTypeBuilder(UA_Server* server, const TypeTree& tree, DataTypeStore& store)
        : server_(server), tree_(tree), store_(store) {}

    /// Describes all structures among the elements.
    /// \return the names of those that the stack cannot describe, each with the reason
    std::vector<std::string> build(const std::vector<DataTypeElement>& elements,
                                   const NodesetIds& names);

    /// The description of a data type: a built-in type for what is only a name for one; null if
    /// there is none.
    const UA_DataType* find(const NodeId& data_type) const;

private:
    enum class State { waiting, open, described, failed };
    struct Slot {
        const DataTypeElement* element;
        UA_DataType* type;
        State state = State::waiting;
        bool lent = false;  ///< another type points to it while it is open
    };

    const UA_DataType* describe(Slot& slot, const NodesetIds& names);
    bool readMembers(Slot& slot, const NodesetIds& names, std::vector<UA_DataTypeMember>& members);
    bool readField(const pugi::xml_node& field, const NodesetIds& names,
                   std::vector<UA_DataTypeMember>& members);
    const UA_DataType* fieldType(const pugi::xml_node& field, const NodeId& id,
                                 const NodesetIds& names);
    const UA_DataType* ofFile(const NodeId& id, const NodesetIds& names, bool by_pointer);
    const UA_DataType* enumeration(const NodeId& id);
    static UA_DataTypeKind kindOf(const Slot& slot, const std::vector<UA_DataTypeMember>& members);
    bool fits(Slot& slot, std::vector<UA_DataTypeMember>& members);
    void hideFailed();
    void begin(const std::vector<DataTypeElement>& elements);
    bool refuse(std::string why);

    UA_Server* server_;
    const TypeTree& tree_;
    DataTypeStore& store_;
    DataTypeStore::Group* group_ = nullptr;
    std::unordered_map<NodeId, Slot> slots_;
    std::vector<Slot*> described_;
    int depth_ = 0;  ///< of open structures within each other
    std::string why_;
};

}  // namespace metier::opcua
