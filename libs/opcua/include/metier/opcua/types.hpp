#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "metier/base/quantities.hpp"
#include "metier/opcua/node_id.hpp"

namespace metier::opcua {

using metier::Range;
using ThreeDFrame = metier::Frame;
using ThreeDVector = metier::Vector3;

/// A name that is unique among siblings; the index belongs to one server's namespace table.
struct QualifiedName {
    std::uint16_t namespace_index = 0;
    std::string name;

    /// Text `2:Skills`; text from the network is made printable.
    std::string toString() const;
    friend bool operator==(const QualifiedName&, const QualifiedName&) = default;
    friend auto operator<=>(const QualifiedName&, const QualifiedName&) = default;
};

/// Text for people; the locale is empty or an RFC 3066 name such as `en`.
struct LocalizedText {
    std::string locale;
    std::string text;

    friend bool operator==(const LocalizedText&, const LocalizedText&) = default;
};

/// An engineering unit (OPC 10000-8, 5.6.3), usually of UNECE Recommendation 20.
struct EuInformation {
    std::string namespace_uri;
    std::int32_t unit_id = -1;
    LocalizedText display_name{};
    LocalizedText description{};

    friend bool operator==(const EuInformation&, const EuInformation&) = default;
};

/// The position in a ThreeDFrame [m].
struct ThreeDCartesianCoordinates {
    double x = 0.0;
    double y = 0.0;
    double z = 0.0;

    friend bool operator==(const ThreeDCartesianCoordinates&,
                           const ThreeDCartesianCoordinates&) = default;
};

/// The orientation in a ThreeDFrame [rad].
struct ThreeDOrientation {
    double a = 0.0;  ///< rotation about x
    double b = 0.0;  ///< rotation about y
    double c = 0.0;  ///< rotation about z; R = Rz(c) Ry(b) Rx(a)

    friend bool operator==(const ThreeDOrientation&, const ThreeDOrientation&) = default;
};

/// One input or output argument of a Method (OPC 10000-3, 8.6).
struct Argument {
    std::string name;
    NodeId data_type;
    std::int32_t value_rank = -1;  ///< -1 scalar, 1 one-dimensional array
    std::vector<std::uint32_t> array_dimensions{};
    LocalizedText description{};

    friend bool operator==(const Argument&, const Argument&) = default;
};

/// Kind of a node (OPC 10000-3, 5).
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
    NodeId type;
    NodeId target;
    QualifiedName browse_name;
    LocalizedText display_name{};
    NodeClass node_class = NodeClass::unspecified;  ///< class of the target
    NodeId type_definition;                         ///< for Objects and Variables only
};

/// Direction in which references are followed: away from a node, or to it.
enum class BrowseDirection { forward, inverse };

}  // namespace metier::opcua
