#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "metier/base/error.hpp"
#include "metier/opcua/session.hpp"
#include "metier/opcua/standard_ids.hpp"
#include "metier/opcua/value.hpp"

namespace metier::opcua {

class ServerCore;  // of src/

/// Names on the way from a node to one below it.
using BrowsePath = std::vector<QualifiedName>;

/// Default id of a child: `<parent>.<name>` in the parent's namespace; below a parent of namespace
/// 0 `<name>` in the namespace of the BrowseName. It shows where a node is, and stays the same when
/// a server is started again.
NodeId childId(const NodeId& parent, const QualifiedName& browse_name);

/// Attributes that every new node has. An empty DisplayName becomes the text of the BrowseName.
struct NodeSpec {
    NodeId id{};      ///< null: a string made of the parent's id and the BrowseName, see childId()
    NodeId parent{};  ///< null: the node has no parent
    NodeId reference = ids::kHasComponent;  ///< type of the reference from the parent to the node
    QualifiedName browse_name{};
    LocalizedText display_name{};
    LocalizedText description{};
};

/// Whether a new Object or Variable comes with the mandatory children of its type.
enum class Children {
    mandatory,
    none,  ///< the caller adds them all: several times faster, but types are not checked
};

/// Type and dimensions of the values that a Variable may hold.
struct VariableShape {
    NodeId data_type;
    std::int32_t value_rank = -1;  ///< as in VariableSpec
    std::vector<std::uint32_t> array_dimensions{};
};

/// Whether clients may subscribe to the events of an Object.
enum class EventNotifier { none, subscribable };

/// A new Object.
struct ObjectSpec {
    NodeSpec node;
    NodeId type = ids::kBaseObjectType;
    EventNotifier event_notifier = EventNotifier::none;
    Children children = Children::mandatory;
};

/// Access of clients to the value of a Variable.
enum class Access { read, read_write };

/// A new Variable.
struct VariableSpec {
    NodeSpec node;
    NodeId type = ids::kBaseDataVariableType;
    NodeId data_type = ids::kBaseDataType;
    std::int32_t value_rank = -1;  ///< -1 scalar, 1 one-dimensional array
    std::vector<std::uint32_t> array_dimensions{};
    Value value{};  ///< empty: a zero of the data type
    Access access = Access::read;
    Children children = Children::mandatory;
};

/// Caller and target of a Method call.
struct CallContext {
    const Session& session;  ///< caller's session
    NodeId object;           ///< Object on which the Method is called
    NodeId method;
};

/// Work of a Method. The stack has checked number and types of the arguments before, if the Method
/// has InputArguments. Called on the server's thread; must return at once.
using MethodHandler =
    std::function<Result<std::vector<Value>>(const CallContext&, std::span<const Value>)>;

/// Right that a session needs to call a Method of a closed server, and whether calls are audited.
enum class MethodEffect {
    commands,  ///< only roles that command; each call is audited
    renews,    ///< only roles that command; repeated all the time, so only denials are audited
    tells,     ///< reports only: all roles; not audited
};

/// A new Method.
struct MethodSpec {
    NodeSpec node;
    std::vector<Argument> inputs{};
    std::vector<Argument> outputs{};
    MethodHandler handler{};
};

/// Writer of a value, and the time at which the value was true, by the writer's clock; none if not
/// sent.
struct WriteContext {
    const Session& session;  ///< writer's session
    std::optional<UtcTime> source_time;
};

/// Source of a Variable's value that is kept elsewhere. Called on the server's thread; both
/// functions must return at once.
struct DataSource {
    std::function<DataValue(const Session&)> read;  ///< present value, for a reader's session
    /// Takes a client's value or refuses it. Type and rank were checked before, except for Null,
    /// which is passed on. Empty: the value is not writable.
    std::function<Result<>(const WriteContext&, const Value&)> write{};
};

/// Source of the values of many Variables, which a tag distinguishes. Works as DataSource, with a
/// tenth of its memory.
class VariableHandler {
public:
    virtual ~VariableHandler() = default;
    /// Present value of the Variable with that tag.
    virtual DataValue read(const Session& session, std::uint32_t tag) const = 0;
    /// Takes a client's value for the Variable with that tag, or refuses it.
    virtual Result<> write(const WriteContext& writer, std::uint32_t tag, const Value& value) = 0;
};

/// Link from a Variable to its handler.
struct VariableSlot {
    VariableHandler* handler = nullptr;
    std::uint32_t tag = 0;  ///< chosen by the handler; distinguishes its Variables
};

/// Selection of references: those of `type` and its subtypes, away from the node or to it.
struct BrowseFilter {
    using Direction = BrowseDirection;
    NodeId type = ids::kHierarchicalReferences;
    Direction direction = Direction::forward;
};

/// Whether an instance shares the Method nodes of its type or has Methods of its own.
enum class MethodNodes {
    shared,  ///< UserExecutable and arguments are the same for all instances
    own,
};

/// The nodes of a server.
///
/// Threading: the server's own thread; before start() the thread that created it. Nothing waits.
/// Errors of every function: those of the table in status_code.hpp; the text names the attempted
/// action.
class AddressSpace {
public:
    explicit AddressSpace(ServerCore& core) : core_(core) {}

    /// The index of a namespace. Errors: not_found.
    Result<std::uint16_t> namespaceIndex(std::string_view uri) const;

    /// Adds an Object with all mandatory children of its type; their ids are childId()s.
    /// Errors: not_found (parent, type), already_exists (id).
    Result<NodeId> addObject(const ObjectSpec& spec, MethodNodes methods = MethodNodes::shared);
    Result<NodeId> addVariable(const VariableSpec& spec);
    Result<NodeId> addMethod(const MethodSpec& spec);
    /// Adds a reference and its inverse. Errors: already_exists, not_found.
    Result<> addReference(const NodeId& source, const NodeId& type, const NodeId& target);
    /// Deletes a node, the children that only it has, and all references to them.
    Result<> deleteNode(const NodeId& id);

    /// The node at the end of a path of hierarchical references. Errors: not_found, naming the
    /// path; invalid_argument (empty path).
    Result<NodeId> find(const NodeId& start, std::span<const QualifiedName> path) const;
    Result<NodeId> find(const NodeId& start, const QualifiedName& child) const;
    Result<std::vector<Reference>> browse(const NodeId& id, const BrowseFilter& filter = {}) const;
    /// Whether the server has a node of that id.
    bool exists(const NodeId& id) const;
    /// Errors: not_found; invalid_argument (no Variable).
    Result<VariableShape> shapeOf(const NodeId& variable) const;
    /// Errors: not_found.
    Result<QualifiedName> browseNameOf(const NodeId& id) const;
    /// Errors: not_found.
    Result<LocalizedText> descriptionOf(const NodeId& id) const;

    /// Value with status and times; from the DataSource if the Variable has one.
    Result<DataValue> read(const NodeId& variable) const;
    /// Sets a value with status Good and the present time; Subscriptions are notified. A Variable
    /// with a DataSource gets the value through its `write`, with a Session of the null id.
    Result<> write(const NodeId& variable, const Value& value);
    Result<> write(const NodeId& variable, const DataValue& value);

    /// Makes a Variable read and written through functions.
    Result<> setDataSource(const NodeId& variable, DataSource source);
    /// Makes a Variable read and written through a handler. `slot` must keep its address until the
    /// server has stopped.
    Result<> setHandler(const NodeId& variable, VariableSlot& slot);
    Result<> setAccess(const NodeId& variable, Access access);
    /// Sets the work of a Method. For a Method node that several Objects share, the context has the
    /// Object.
    Result<> setMethod(const NodeId& method, MethodHandler handler,
                       MethodEffect effect = MethodEffect::commands);
    /// Sets the answer to reads of UserExecutable. It forbids nothing: the handler must refuse the
    /// call itself.
    Result<> setExecutable(const NodeId& method, std::function<bool(const Session&)> predicate);
    Result<> setEventNotifier(const NodeId& object, EventNotifier notifier);

private:
    Result<> giveOwnMethods(const NodeId& object);
    Result<> copyMethod(const NodeId& object, const Reference& method);

    ServerCore& core_;
};

}  // namespace metier::opcua
