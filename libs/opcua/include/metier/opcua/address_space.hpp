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

/// BrowseNames on the way from a node to one below it, the nearest first.
using BrowsePath = std::vector<QualifiedName>;

/// Default id of a child: `<parent>.<name>` in the parent's namespace; below a parent of namespace
/// 0 `<name>` in the namespace of the BrowseName. It shows where a node is, and stays the same when
/// a server is started again.
NodeId childId(const NodeId& parent, const QualifiedName& browse_name);

/// Attributes that every new node has. An empty DisplayName becomes the text of the BrowseName.
struct NodeSpec {
    /// Id of the new node; null: a string made of the parent's id and the BrowseName, see
    /// childId().
    NodeId id{};
    /// Node above; null: the node has no parent.
    NodeId parent{};
    /// Type of the reference from the parent to the node.
    NodeId reference = ids::kHasComponent;
    /// Name among its siblings.
    QualifiedName browse_name{};
    /// Name for people; empty: the text of the BrowseName.
    LocalizedText display_name{};
    /// Text for people; may be empty.
    LocalizedText description{};
};

/// Whether a new Object or Variable comes with the mandatory children of its type.
enum class Children {
    /// The stack adds them and checks the type.
    mandatory,
    /// The caller adds them all: several times faster, but types are not checked.
    none,
};

/// Type and dimensions of the values that a Variable may hold.
struct VariableShape {
    /// Data type, or a supertype of what it may hold.
    NodeId data_type;
    /// Number of dimensions, as in VariableSpec.
    std::int32_t value_rank = -1;
    /// Length of each dimension, 0: any; empty: not fixed.
    std::vector<std::uint32_t> array_dimensions{};
};

/// Whether clients may subscribe to the events of an Object.
enum class EventNotifier { none, subscribable };

/// A new Object.
struct ObjectSpec {
    /// Attributes and place.
    NodeSpec node;
    /// Type definition, an ObjectType of this server.
    NodeId type = ids::kBaseObjectType;
    /// Whether clients may subscribe to its events.
    EventNotifier event_notifier = EventNotifier::none;
    /// Whether it comes with the children of its type.
    Children children = Children::mandatory;
};

/// Access of clients to the value of a Variable. A server with security lets only roles that
/// command write.
enum class Access { read, read_write };

/// A new Variable.
struct VariableSpec {
    /// Attributes and place.
    NodeSpec node;
    /// Type definition, a VariableType of this server.
    NodeId type = ids::kBaseDataVariableType;
    /// Data type, or a supertype of what it may hold.
    NodeId data_type = ids::kBaseDataType;
    /// Number of dimensions: -1 scalar, 1 one-dimensional array (OPC 10000-3, 5.6.2).
    std::int32_t value_rank = -1;
    /// Length of each dimension, 0: any; empty: not fixed.
    std::vector<std::uint32_t> array_dimensions{};
    /// First value; empty: a zero of the data type.
    Value value{};
    /// Access of clients; the server's own write() is not bound by it.
    Access access = Access::read;
    /// Whether it comes with the children of its type.
    Children children = Children::mandatory;
};

/// Caller and target of a Method call.
struct CallContext {
    /// Session of the caller; valid during the call.
    const Session& session;
    /// Object on which the Method is called; distinguishes those that share a Method node.
    NodeId object;
    /// Method node that was called.
    NodeId method;
};

/// Work of a Method: gets the input arguments, returns the output arguments. The stack has checked
/// number and types of the arguments before, if the Method has InputArguments. Called on the
/// server's thread; must return at once. An error becomes a StatusCode by the table of
/// status_code.hpp; its text stays here.
using MethodHandler =
    std::function<Result<std::vector<Value>>(const CallContext&, std::span<const Value>)>;

/// Right that a session needs to call a Method of a closed server, and whether calls are audited.
enum class MethodEffect {
    /// Only roles that command may call it; each call is audited.
    commands,
    /// Only roles that command may call it; repeated all the time, so only denials are audited.
    renews,
    /// Reports only: all roles may call it; not audited.
    tells,
};

/// A new Method.
struct MethodSpec {
    /// Attributes and place; the node that AddressSpace::addMethod() makes commands, see
    /// MethodEffect.
    NodeSpec node;
    /// Arguments of a call, in order; the Property InputArguments.
    std::vector<Argument> inputs{};
    /// Results of a call, in order; the Property OutputArguments.
    std::vector<Argument> outputs{};
    /// Work of the Method; empty: nobody may call it, see AddressSpace::setMethod().
    MethodHandler handler{};
};

/// Writer of a value, and the time at which the value was true, by the writer's clock; none if not
/// sent.
struct WriteContext {
    /// Session of the writer; valid during the call. The null id is the server itself.
    const Session& session;
    /// SourceTimestamp of the write.
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
    /// Takes a client's value for the Variable with that tag, or refuses it. Errors become
    /// StatusCodes by the table of status_code.hpp. Both functions run on the server's thread and
    /// must return at once.
    virtual Result<> write(const WriteContext& writer, std::uint32_t tag, const Value& value) = 0;
};

/// Link from a Variable to its handler.
struct VariableSlot {
    /// Handler of the Variable; must outlive the server.
    VariableHandler* handler = nullptr;
    /// Number chosen by the handler; distinguishes its Variables.
    std::uint32_t tag = 0;
};

/// Selection of references: those of `type` and its subtypes, away from the node or to it.
struct BrowseFilter {
    using Direction = BrowseDirection;
    /// Type of the references that are followed, with its subtypes.
    NodeId type = ids::kHierarchicalReferences;
    /// Direction away from the node, or to it.
    Direction direction = Direction::forward;
};

/// Whether an instance shares the Method nodes of its type or has Methods of its own.
enum class MethodNodes {
    /// One Method node for all instances: UserExecutable and arguments are the same for all.
    shared,
    /// A copy of each Method node, which shares the arguments of the type.
    own,
};

/// The nodes of a server: what clients see is made and changed here.
///
///     auto lamp = nodes.addVariable({.node = {.parent = object, .browse_name = {1, "Lamp"}},
///                                    .data_type = ids::kBoolean,
///                                    .access = Access::read_write});
///     nodes.setDataSource(*lamp, {.read = [&](const Session&) { return DataValue{...}; }});
///
/// Threading: the server's own thread; before start() the thread that created it. Nothing waits.
/// Valid as long as the Server.
/// Errors of every function: those of the table in status_code.hpp, not_found for an id that does
/// not exist; the text names the attempted action.
class AddressSpace {
public:
    explicit AddressSpace(ServerCore& core) : core_(core) {}

    /// The index of a namespace, for the NodeIds of this server. Errors: not_found.
    Result<std::uint16_t> namespaceIndex(std::string_view uri) const;

    /// Adds an Object with all mandatory children of its type; their ids are childId()s.
    /// \return its id
    /// Errors: not_found (parent, type), already_exists (id).
    Result<NodeId> addObject(const ObjectSpec& spec, MethodNodes methods = MethodNodes::shared);
    /// Adds a Variable; as addObject().
    Result<NodeId> addVariable(const VariableSpec& spec);
    /// Adds a Method with its arguments and its work; as addObject().
    Result<NodeId> addMethod(const MethodSpec& spec);
    /// Adds a reference and its inverse. Errors: already_exists, not_found.
    Result<> addReference(const NodeId& source, const NodeId& type, const NodeId& target);
    /// Adds all nodes of a NodeSet2.xml text, as ServerOptions::nodeset_files does, but for event
    /// types: their fields must be known before the server is made.
    /// \param name stands for the file in messages
    /// Errors: invalid_argument with a line "name:line: why" for each mistake; the nodes before it
    ///         stay.
    Result<> addNodeset(std::string_view xml, std::string name);
    /// Deletes a node, the children that only it has, and all references to them. Errors:
    /// not_found.
    Result<> deleteNode(const NodeId& id);

    /// The node at the end of a path of hierarchical references. Errors: not_found, naming the
    /// path; invalid_argument (empty path).
    Result<NodeId> find(const NodeId& start, std::span<const QualifiedName> path) const;
    /// The child of that name. Errors: not_found.
    Result<NodeId> find(const NodeId& start, const QualifiedName& child) const;
    /// References of a node that the filter selects. Errors: not_found.
    Result<std::vector<Reference>> browse(const NodeId& id, const BrowseFilter& filter = {}) const;
    /// Whether the server has a node of that id.
    bool exists(const NodeId& id) const;
    /// Data type and dimensions of a Variable. Errors: not_found; internal (no Variable).
    Result<VariableShape> shapeOf(const NodeId& variable) const;
    /// BrowseName of a node. Errors: not_found.
    Result<QualifiedName> browseNameOf(const NodeId& id) const;
    /// Description of a node; empty if it has none. Errors: not_found.
    Result<LocalizedText> descriptionOf(const NodeId& id) const;

    /// Value with status and times; from the DataSource if the Variable has one. A Bad status of
    /// the value is no error here.
    /// Errors: not_found; internal (no Variable).
    Result<DataValue> read(const NodeId& variable) const;
    /// Sets a value with status Good and the present time; Subscriptions are notified. A Variable
    /// with a DataSource gets the value through its `write`, with a Session of the null id.
    /// Errors: not_found, type_mismatch; those of a DataSource.
    Result<> write(const NodeId& variable, const Value& value);
    /// Sets a value with its own status and source time; else as above.
    Result<> write(const NodeId& variable, const DataValue& value);

    /// Makes a Variable read and written through functions, which live as long as the node.
    Result<> setDataSource(const NodeId& variable, DataSource source);
    /// Makes a Variable read and written through a handler. `slot` must keep its address until the
    /// server has stopped.
    Result<> setHandler(const NodeId& variable, VariableSlot& slot);
    /// Changes whether clients may write a Variable; mind that a DataSource without `write`
    /// refuses.
    Result<> setAccess(const NodeId& variable, Access access);
    /// Sets the work of a Method; without work it is not Executable, and a call is refused. For a
    /// Method node that several Objects share, the context has the Object.
    /// \param effect right that callers need, and whether calls are audited
    Result<> setMethod(const NodeId& method, MethodHandler handler,
                       MethodEffect effect = MethodEffect::commands);
    /// Sets the answer to reads of UserExecutable, asked on the server's thread. It forbids
    /// nothing: the handler must refuse the call itself.
    Result<> setExecutable(const NodeId& method, std::function<bool(const Session&)> predicate);
    /// Changes whether clients may subscribe to the events of an Object.
    Result<> setEventNotifier(const NodeId& object, EventNotifier notifier);

private:
    Result<> giveOwnMethods(const NodeId& object);
    Result<> copyMethod(const NodeId& object, const Reference& method);

    ServerCore& core_;
};

}  // namespace metier::opcua
