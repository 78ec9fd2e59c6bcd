#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "metier/base/error.hpp"

namespace metier::opcua {

/// Bytes without a meaning to OPC UA (OPC 10000-6, 5.2.2.7).
/// Not text: show it as base64 or hexadecimal, if at all.
struct ByteString {
    /// Any number of bytes, also none.
    std::vector<std::uint8_t> bytes;

    friend bool operator==(const ByteString&, const ByteString&) = default;
    friend auto operator<=>(const ByteString&, const ByteString&) = default;
};

/// A 128-bit identifier in the four fields of OPC 10000-6, 5.1.3.
///
/// Threading: a value type. The fields are numbers; their order of bytes on the wire is the codec's
/// concern.
struct Guid {
    /// Fields in the order of their text: data1-data2-data3-data4.
    std::uint32_t data1 = 0;
    std::uint16_t data2 = 0;
    std::uint16_t data3 = 0;
    std::array<std::uint8_t, 8> data4{};

    friend bool operator==(const Guid&, const Guid&) = default;
    friend auto operator<=>(const Guid&, const Guid&) = default;
};

/// Id of a node of one server. The namespace index is that server's own: it differs between servers
/// and may change when one restarts.
///
/// Threading: a value type.
///
///     const NodeId state{0, 2259U};                        // i=2259, of the standard
///     const auto lamp = NodeId::parse("ns=2;s=Cell.Lamp");  // a Result
///     nodes.write(*lamp, Value::of(true));
class NodeId {
public:
    /// Number, text, Guid or bytes.
    using Identifier = std::variant<std::uint32_t, std::string, Guid, ByteString>;

    /// The null NodeId, i=0.
    NodeId() = default;
    /// Numeric id: ns=2;i=5.
    NodeId(std::uint16_t namespace_index, std::uint32_t id)
        : namespace_index_(namespace_index), identifier_(id) {}
    /// Text as id: ns=2;s=Name.
    /// \param id up to 4096 characters by the standard, which is not checked
    NodeId(std::uint16_t namespace_index, std::string id)
        : namespace_index_(namespace_index), identifier_(std::move(id)) {}
    /// Guid as id: ns=2;g=...
    NodeId(std::uint16_t namespace_index, Guid id)
        : namespace_index_(namespace_index), identifier_(id) {}
    /// Bytes as id: ns=2;b=...
    NodeId(std::uint16_t namespace_index, ByteString id)
        : namespace_index_(namespace_index), identifier_(std::move(id)) {}

    /// Reads the notation of OPC 10000-6, 5.3.1.10: `ns=2;i=5`, `i=85`, `ns=1;s=Name`,
    /// `ns=1;g=<guid>`, `ns=1;b=<base64>`.
    /// A number that does not fit into 16 or 32 bits is an error too, not another node. The message
    /// shows the text, made printable.
    /// Errors: invalid_argument.
    static Result<NodeId> parse(std::string_view text);

    /// Index in the namespace table of its server.
    std::uint16_t namespaceIndex() const noexcept { return namespace_index_; }
    /// Id within the namespace; valid as long as this.
    const Identifier& identifier() const noexcept { return identifier_; }
    /// Whether it is a null id: i=0, an empty string, ... in namespace 0.
    /// A null id stands for "none", such as no parent or no type definition.
    bool isNull() const;
    /// Notation that parse() reads; text from the network is made printable.
    std::string toString() const;
    /// Hash for containers; the same for equal ids of one process.
    std::size_t hash() const noexcept;

    friend bool operator==(const NodeId&, const NodeId&) = default;
    /// Order by namespace index, then kind of identifier, then identifier; good for containers
    /// only.
    friend auto operator<=>(const NodeId&, const NodeId&) = default;

private:
    std::uint16_t namespace_index_ = 0;
    Identifier identifier_ = std::uint32_t{0};
};

}  // namespace metier::opcua

/// Makes NodeId the key of unordered containers.
template <>
struct std::hash<metier::opcua::NodeId> {
    std::size_t operator()(const metier::opcua::NodeId& id) const noexcept { return id.hash(); }
};
