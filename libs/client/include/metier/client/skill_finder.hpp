#pragma once

#include <string>
#include <vector>

#include "metier/opcua/client.hpp"

namespace metier::client {

/// Where a skill is in a server.
struct SkillAddress {
    std::string name;          ///< BrowseName: "CartesianLinearMoveSkill"
    std::string display_name;  ///< for people
    opcua::NodeId node;
    opcua::NodeId type;
    std::string type_name;  ///< BrowseName of its type: "CartesianLinearMoveSkillType"
    /// Objects on the way from the Objects folder to it, the nearest last; names and nodes.
    struct Above {
        std::string name;
        opcua::NodeId node;
    };
    std::vector<Above> above;

    /// The object that holds the folder `Skills`: its controller. Null if there is none.
    const Above* controller() const;
    /// Its name; empty if there is none.
    std::string controllerName() const;
};

/// Every object below the Objects folder whose type is ProgramStateMachineType or a subtype.
///
/// Nothing but the address space is needed: it knows no robot and no maker.
/// Errors:  the server's. Threads: any but the client's own; waits.
opcua::Answer<std::vector<SkillAddress>> findSkills(opcua::Client& client);

struct SkillType {
    std::string name;  ///< BrowseName
    opcua::NodeId node;
};

/// A skill's type and all types that it is derived from, its own first, the last one directly below
/// ProgramStateMachineType. Errors and threads: as findSkills().
opcua::Answer<std::vector<SkillType>> typeChain(opcua::Client& client, const SkillAddress& skill);

/// The skill of that name.
/// \param name a BrowseName, or "Controller/BrowseName" where several controllers have one
/// Errors: not_found, with the names there are; invalid_argument if several match.
opcua::Answer<SkillAddress> findSkill(opcua::Client& client, std::string_view name);

}  // namespace metier::client
