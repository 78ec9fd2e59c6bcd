#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "metier/opcua/client.hpp"
#include "metier/skill/state.hpp"

namespace metier::client {

/// Position of a skill in a server's address space.
struct SkillAddress {
    /// BrowseName: "CartesianLinearMoveSkill". Control characters that the server sent are
    /// replaced, as in all texts here.
    std::string name;
    /// Name for people.
    std::string display_name;
    /// Object of the skill, with the namespace index of this session.
    opcua::NodeId node;
    /// Its type definition.
    opcua::NodeId type;
    /// BrowseName of its type: "CartesianLinearMoveSkillType".
    std::string type_name;
    /// Objects on the path from the Objects folder to the skill, the nearest one last.
    struct Above {
        /// BrowseName of the object.
        std::string name;
        /// The object.
        opcua::NodeId node;
    };
    /// All of them; empty for a skill right below the Objects folder.
    std::vector<Above> above;
    /// BrowseNames of the types from which its type is derived, the nearest first, up to the one
    /// directly below ProgramStateMachineType.
    std::vector<std::string> base_types{};

    /// Whether it may stand in for a skill of a type: its type is that one or is derived from it.
    /// A name may lack the ending "Type", as those of the published gripper skills do. A force move
    /// stands in for no other move, since it needs a force.
    /// \param wanted BrowseName
    bool servesAs(std::string_view wanted) const;

    /// The controller of the skill: the object that has the folder `Skills`. Null if there is none.
    /// Valid as long as this address is not changed.
    const Above* controller() const;
    /// BrowseName of the controller; empty if there is none.
    std::string controllerName() const;
};

/// Finds every object below the Objects folder whose type is ProgramStateMachineType or a subtype,
/// down to 12 objects deep.
///
/// Uses nothing but the address space; knows no robot and no maker.
/// Errors: those of the server, connection_lost, timeout. Threads: any but the client's own; waits.
opcua::Answer<std::vector<SkillAddress>> findSkills(opcua::Client& client);

/// Finds a Method of a skill by its BrowseName; in namespace 0, or else in any other: servers of
/// other makers may have it there.
/// Errors: not_found (BadNoMatch); those of the server. Threads: as findSkills().
opcua::Answer<opcua::NodeId> findMethod(opcua::Client& client, const SkillAddress& skill,
                                        skill::Method method);

/// A type in the chain of a skill's types.
struct SkillType {
    /// BrowseName, such as "SkillType".
    std::string name;
    /// The ObjectType.
    opcua::NodeId node;
};

/// Reads a skill's type and all types from which it is derived: its own first, the last one
/// directly below ProgramStateMachineType. Errors and threads: as findSkills().
opcua::Answer<std::vector<SkillType>> typeChain(opcua::Client& client, const SkillAddress& skill);

/// Finds the skill of that name among findSkills().
/// \param name a BrowseName; "Controller/BrowseName" if several controllers have such a skill
/// Errors: not_found, with the existing names; invalid_argument if several match; those of
///         findSkills(). Threads: as findSkills().
opcua::Answer<SkillAddress> findSkill(opcua::Client& client, std::string_view name);

}  // namespace metier::client
