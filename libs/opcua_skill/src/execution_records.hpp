#pragma once

#include <cstddef>

#include "metier/base/error.hpp"
#include "metier/opcua/address_space.hpp"
#include "metier/skill/program.hpp"

namespace metier::opcua_skill {

/// So many executions of a skill can be browsed.
inline constexpr std::size_t kBrowsableExecutions = 10;

/// Shows the last executions of a Program below its skill: `ExecutionRecords/Latest`, `Latest-1`,
/// and so on. Values are read from the Program when a client asks; BadNoData where there was no
/// such execution yet.
///
/// \param skill   the Program's object
/// \param program must outlive the server
/// Threading: as opcua::AddressSpace.
/// Errors: not_found, if the server's NodeSets lack the types.
Result<void> publishExecutionRecords(opcua::AddressSpace& nodes, const opcua::NodeId& skill,
                                     const skill::Program& program);

}  // namespace metier::opcua_skill
