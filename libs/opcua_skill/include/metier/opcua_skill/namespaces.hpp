#pragma once

#include <string_view>

namespace metier::opcua_skill {

/// Of what metier adds to the published types of skills.
inline constexpr std::string_view kMetierUri = "urn:metier:skills";

}  // namespace metier::opcua_skill
