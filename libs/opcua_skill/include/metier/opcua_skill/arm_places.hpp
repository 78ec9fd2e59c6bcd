#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "metier/opcua/value.hpp"
#include "metier/skill/skill.hpp"

namespace metier::opcua_skill {

// Places of arms among the pairs that Check takes and gives. The key of the own server's arm is one
// of the names below; that of another server's arm is followed by @ and the server's address.

/// Key of a place where an arm stands when the skill begins [rad]; a pair of the input of Check.
inline constexpr std::string_view kStartJointPosition = "StartJointPosition";
/// Key of a place where an arm stands at the end [rad]; a pair of the output of Check.
inline constexpr std::string_view kEndJointPosition = "EndJointPosition";

/// Pairs for the places of arms, each a Double[]; one without values: not known.
/// \param key kStartJointPosition or kEndJointPosition
/// Threads: any.
std::vector<opcua::KeyValue> pairsOf(const skill::ArmPositions& arms, std::string_view key);

/// Arm that a pair is about, as a key of skill::ArmPositions; nothing if it is no place of an arm.
/// Threads: any.
std::optional<std::string> armIn(std::string_view name, std::string_view key);

}  // namespace metier::opcua_skill
