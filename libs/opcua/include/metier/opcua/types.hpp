#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "metier/base/quantities.hpp"
#include "metier/opcua/node_id.hpp"

namespace metier::opcua {

/// The structures that the whole project uses, under their names in OPC UA.
using metier::Range;
using ThreeDFrame = metier::Frame;
using ThreeDVector = metier::Vector3;

/// A name that is unique among siblings; the index belongs to one server's namespace table.
///
///     const auto index = client.namespaceIndex("http://example.org/robot/");
///     const QualifiedName skills{*index, "Skills"};
struct QualifiedName {
    /// Index of its namespace.
    std::uint16_t namespace_index = 0;
    /// Name without the index.
    std::string name;

    /// Text `2:Skills`; text from the network is made printable.
    /// Namespace 0 is written too: `0:Objects`.
    std::string toString() const;
    /// Upper and lower case differ. Names of two servers must not be compared: their indices
    /// differ.
    friend bool operator==(const QualifiedName&, const QualifiedName&) = default;
    friend auto operator<=>(const QualifiedName&, const QualifiedName&) = default;
};

/// Text for people; the locale is empty or an RFC 3066 name such as `en`.
/// Never the key of anything: a client may ask for another language and get another text.
struct LocalizedText {
    /// Language; empty: not known.
    std::string locale;
    /// Text in UTF-8.
    /// Unchecked if it came from the network: sanitise() it before it is shown.
    std::string text;

    friend bool operator==(const LocalizedText&, const LocalizedText&) = default;
};

/// An engineering unit (OPC 10000-8, 5.6.3), usually of UNECE Recommendation 20.
/// A Property EngineeringUnits of a Variable has it; its values are then in this unit.
struct EuInformation {
    /// Table of the unit; for UNECE "http://www.opcfoundation.org/UA/units/un/cefact".
    std::string namespace_uri;
    /// Number in that table; -1: none.
    std::int32_t unit_id = -1;
    /// Symbol: "m/s".
    LocalizedText display_name{};
    /// Name: "metre per second".
    LocalizedText description{};

    friend bool operator==(const EuInformation&, const EuInformation&) = default;
};

/// The position in a ThreeDFrame [m].
struct ThreeDCartesianCoordinates {
    /// Along the axes of the frame to which the ThreeDFrame refers.
    double x = 0.0;
    double y = 0.0;
    double z = 0.0;

    friend bool operator==(const ThreeDCartesianCoordinates&,
                           const ThreeDCartesianCoordinates&) = default;
};

/// The orientation in a ThreeDFrame [rad].
/// Angles are applied about the fixed axes: first a, then b, then c.
struct ThreeDOrientation {
    /// Rotation about x.
    double a = 0.0;
    /// Rotation about y.
    double b = 0.0;
    /// Rotation about z; R = Rz(c) Ry(b) Rx(a).
    double c = 0.0;

    friend bool operator==(const ThreeDOrientation&, const ThreeDOrientation&) = default;
};

/// One input or output argument of a Method (OPC 10000-3, 8.6).
///
///     Argument{.name = "Height", .data_type = ids::kDouble, .description = {"en", "Height [m]"}}
struct Argument {
    /// Name within its Method.
    std::string name;
    /// Data type of the value.
    /// An abstract one accepts every subtype; ids::kBaseDataType accepts any value.
    NodeId data_type;
    /// Number of dimensions: -1 scalar, 1 one-dimensional array.
    std::int32_t value_rank = -1;
    /// Length of each dimension, 0: any; empty: not fixed.
    std::vector<std::uint32_t> array_dimensions{};
    /// Text for people.
    LocalizedText description{};

    friend bool operator==(const Argument&, const Argument&) = default;
};

/// Kind of a node (OPC 10000-3, 5).
/// The values are bits, as a mask of classes in the Browse service needs them.
enum class NodeClass {
    unspecified = 0,
    object = 1,
    variable = 2,
    method = 4,
    object_type = 8,
    variable_type = 16,
    reference_type = 32,
    data_type = 64,
    view = 128,
};

/// A reference of a node and its target.
struct Reference {
    /// Type of the reference.
    NodeId type;
    /// Node at its other end.
    NodeId target;
    /// Names of the target.
    QualifiedName browse_name;
    LocalizedText display_name{};
    /// Class of the target.
    NodeClass node_class = NodeClass::unspecified;
    /// Type definition of the target, for Objects and Variables only; else null.
    NodeId type_definition;
};

/// Direction in which references are followed: away from a node, or to it.
/// Both at once, as the standard allows, is not offered.
enum class BrowseDirection { forward, inverse };

}  // namespace metier::opcua
