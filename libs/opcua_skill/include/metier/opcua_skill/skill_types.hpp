#pragma once

#include <string>
#include <string_view>

#include "metier/base/error.hpp"
#include "metier/opcua/address_space.hpp"
#include "metier/skill/skill_type.hpp"

namespace metier::opcua_skill {

// Skill types that are declared at run time become ObjectTypes in a namespace of their own. Their
// NodeIds are texts made of their names, such as `s=SpotWeldSkillType/ParameterSet/Current`: the
// same in each server and at each start.
//
// Threads: the server's own thread; before Server::start() the one that created it.

/// The NodeSet2.xml text of skill types, which other servers and clients can load.
/// \param nodes of a server with the NodeSets device, robotics and metier, and the types from which
///              these are derived
/// Errors: invalid_argument, with a line for each mistake: a base that is not there, a circle of
///         bases, a name twice or taken by another type; a namespace without a URI.
Result<std::string> nodesetOf(const skill::SkillTypes& types, const opcua::AddressSpace& nodes);

/// The same without a server: derived types of metier's own model only. Makes a server that opens
/// no port, on the calling thread, whatever thread that is.
/// Errors: as above; internal (the stack).
Result<std::string> nodesetOf(const skill::SkillTypes& types);

/// Adds the types to a server, so that SkillServer::publish() makes skills of them.
/// Errors: those of nodesetOf() and AddressSpace::addNodeset().
Result<void> declareTypes(opcua::AddressSpace& nodes, const skill::SkillTypes& types);

/// Whether the server has a skill type of that name.
bool hasSkillType(const opcua::AddressSpace& nodes, std::string_view name);

}  // namespace metier::opcua_skill
