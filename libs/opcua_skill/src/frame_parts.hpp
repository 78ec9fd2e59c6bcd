#pragma once

#include <array>
#include <utility>
#include <vector>

#include "metier/opcua/address_space.hpp"
#include "purpose.hpp"

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
    if (auto done = work(frame, Part::whole); !done) {
        return done;
    }
    for (const auto& row : kFrameParts) {
        std::vector<opcua::QualifiedName> path{{0, row.group}};
        if (row.name != nullptr) {
            path.push_back({0, row.name});
        }
        const auto node = nodes.find(frame, path);
        if (!node) {
            return fail(node.error());
        }
        if (auto done = work(*node, row.part); !done) {
            return done;
        }
    }
    return {};
}

}  // namespace metier::opcua_skill
