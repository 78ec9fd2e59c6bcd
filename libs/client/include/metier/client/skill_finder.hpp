#pragma once

#include <string>
#include <vector>

#include "metier/opcua/client.hpp"

namespace metier::client {

/// Position of a skill in a server's address space.
struct SkillAddress {
    std::string name;          ///< BrowseName: "CartesianLinearMoveSkill"
    std::string display_name;  ///< for people
    opcua::NodeId node;
    opcua::NodeId type;
    std::string type_name;  ///< BrowseName of its type: "CartesianLinearMoveSkillType"
    /// Objects on the path from the Objects folder to the skill, the nearest one last.
    struct Above {
        std::string name;
        opcua::NodeId node;
    };
    std::vector<Above> above;

    /// The controller of the skill: the object that has the folder `Skills`. Null if there is none.
    const Above* controller() const;
    /// BrowseName of the controller; empty if there is none.
    std::string controllerName() const;
};

/// Finds every object below the Objects folder whose type is ProgramStateMachineType or a subtype.
///
/// Uses nothing but the address space; knows no robot and no maker.
/// Errors: those of the server. Threads: any but the client's own; waits.
opcua::Answer<std::vector<SkillAddress>> findSkills(opcua::Client& client);

struct SkillType {
    std::string name;  ///< BrowseName
    opcua::NodeId node;
};

/// Reads a skill's type and all types from which it is derived: its own first, the last one
/// directly below ProgramStateMachineType. Errors and threads: as findSkills().
opcua::Answer<std::vector<SkillType>> typeChain(opcua::Client& client, const SkillAddress& skill);

/// Finds the skill of that name.
/// \param name a BrowseName; "Controller/BrowseName" if several controllers have such a skill
/// Errors: not_found, with the existing names; invalid_argument if several match.
opcua::Answer<SkillAddress> findSkill(opcua::Client& client, std::string_view name);

}  // namespace metier::client
