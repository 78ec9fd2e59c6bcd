#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "metier/opcua/answer.hpp"
#include "metier/opcua/value.hpp"
#include "metier/skill/execution_record.hpp"
#include "metier/skill/field.hpp"
#include "metier/skill/program.hpp"
#include "metier/skill/skill.hpp"
#include "skill_nodes.hpp"

namespace metier::client {

// Arguments of the methods of namespace urn:metier:skills. Errors: BadUnexpectedError, with the
// skill's name, for outputs of another shape.

/// A reason by its number; a number that is none becomes a reason whose name is "unknown".
skill::Reason reasonFrom(std::int32_t number);

/// Inputs of Check.
std::vector<opcua::Value> checkInputs(const skill::CheckRequest& request);
std::vector<opcua::Value> startWithInputs(const skill::StartRequest& request,
                                          const SkillNodes& nodes);
opcua::Answer<skill::CheckReport> checkReportFrom(const std::vector<opcua::Value>& outputs,
                                                  std::string_view skill);
/// \param results as the skill declares them
opcua::Answer<skill::ExecutionRecord> executionFrom(const std::vector<opcua::Value>& outputs,
                                                    const std::string& id,
                                                    const skill::Fields& results,
                                                    std::string_view skill);

}  // namespace metier::client
