#pragma once

#include <cstdint>
#include <string_view>

namespace metier::opcua_skill {

/// Of what metier adds to the published types of skills.
inline constexpr std::string_view kMetierUri = "urn:metier:skills";
/// SkillStoppingEventType in that namespace.
inline constexpr std::uint32_t kStoppingEventTypeId = 20344;

}  // namespace metier::opcua_skill
