#pragma once

#include <string_view>

namespace metier::opcua_skill {

// Keys in the Parameters of StartWith that are no parameters: on whose behalf a skill is started.
// A skill that has ExecutionRecords takes them.

/// ExecutionId of the execution that starts the skill.
inline constexpr std::string_view kParentExecution = "ParentExecution";
/// ApplicationUri of its server.
inline constexpr std::string_view kParentServer = "ParentServer";

}  // namespace metier::opcua_skill
