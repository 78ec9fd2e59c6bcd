#pragma once

#include <string_view>

namespace metier::opcua_skill {

// Keys in the Parameters of StartWith that are not parameters of the skill: the execution on whose
// behalf it is started. Skills with ExecutionRecords accept them.

/// ExecutionId of the starting execution.
inline constexpr std::string_view kParentExecution = "ParentExecution";
/// ApplicationUri of the starting execution's server.
inline constexpr std::string_view kParentServer = "ParentServer";

}  // namespace metier::opcua_skill
