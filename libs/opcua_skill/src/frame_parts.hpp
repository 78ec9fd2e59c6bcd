#pragma once

#include <array>
#include <utility>
#include <vector>

#include "metier/opcua/address_space.hpp"
#include "node_role.hpp"

namespace metier::opcua_skill {

/// A part of a 3DFrame that is a Variable of its own.
struct FramePart {
    const char* group;
    const char* name;  ///< null: the group itself
    Part part;
};

inline constexpr std::array kFrameParts{
    FramePart{"CartesianCoordinates", nullptr, Part::position},
    FramePart{"CartesianCoordinates", "X", Part::x},
    FramePart{"CartesianCoordinates", "Y", Part::y},
    FramePart{"CartesianCoordinates", "Z", Part::z},
    FramePart{"Orientation", nullptr, Part::orientation},
    FramePart{"Orientation", "A", Part::a},
    FramePart{"Orientation", "B", Part::b},
    FramePart{"Orientation", "C", Part::c},
};

/// Runs `work` for the Variable of a 3DFrame and for each Variable of its parts.
template <typename Work>
Result<void> forEachPart(opcua::AddressSpace& nodes, const opcua::NodeId& frame, Work work) {
    METIER_TRY(work(frame, Part::whole));
    for (const auto& row : kFrameParts) {
        std::vector<opcua::QualifiedName> path{{0, row.group}};
        if (row.name != nullptr) {
            path.push_back({0, row.name});
        }
        METIER_ASSIGN(const auto node, nodes.find(frame, path));
        METIER_TRY(work(node, row.part));
    }
    return {};
}

}  // namespace metier::opcua_skill
