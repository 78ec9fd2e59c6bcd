#pragma once

#include <cstdint>
#include <string_view>

namespace metier::opcua_skill {

/// Namespace of metier's additions to the published skill types.
inline constexpr std::string_view kMetierUri = "urn:metier:skills";
/// Numeric id of SkillStoppingEventType in that namespace.
inline constexpr std::uint32_t kStoppingEventTypeId = 20344;

}  // namespace metier::opcua_skill
