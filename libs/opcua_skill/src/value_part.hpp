#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "metier/base/error.hpp"
#include "metier/base/text.hpp"
#include "metier/opcua/address_space.hpp"
#include "metier/opcua/value.hpp"
#include "metier/skill/field.hpp"
#include "node_role.hpp"

namespace metier::opcua_skill {

/// That part of a field's value, in the form in which it is sent; the empty value if there is none.
opcua::Value partOf(const skill::Value& value, Part part);

/// The field's value with one part replaced; parts that were never set are zero.
/// Errors: type_mismatch.
Result<skill::Value> withPart(const skill::Field& field, const skill::Value& old, Part part,
                              const opcua::Value& value);

/// A Variable of a 3DFrame.
struct FramePart {
    std::string_view path;  ///< below the frame's own Variable; empty: this one
    Part part;
};

inline constexpr std::array kFrameParts{
    FramePart{"", Part::whole},
    FramePart{"CartesianCoordinates", Part::position},
    FramePart{"CartesianCoordinates/X", Part::x},
    FramePart{"CartesianCoordinates/Y", Part::y},
    FramePart{"CartesianCoordinates/Z", Part::z},
    FramePart{"Orientation", Part::orientation},
    FramePart{"Orientation/A", Part::a},
    FramePart{"Orientation/B", Part::b},
    FramePart{"Orientation/C", Part::c},
};

/// Runs `work` for the Variable of a 3DFrame and for each Variable of its parts.
template <typename Work>
Result<void> forEachPart(opcua::AddressSpace& nodes, const opcua::NodeId& frame, Work work) {
    for (const auto& row : kFrameParts) {
        std::vector<opcua::QualifiedName> path;
        for (const auto name : split(row.path, '/')) {
            path.push_back({0, std::string(name)});
        }
        METIER_ASSIGN(const auto node, path.empty() ? frame : nodes.find(frame, path));
        METIER_TRY(work(node, row.part));
    }
    return {};
}

}  // namespace metier::opcua_skill
