#pragma once

#include <optional>

#include "metier/opcua/client.hpp"
#include "metier/skill_client/skill_finder.hpp"

namespace metier::app {

/// The reach of the arm that a skill moves [m]; nothing if it moves none, or its server does not
/// tell enough. Waits for the server.
std::optional<double> reachOf(opcua::Client& client, const skill_client::SkillAddress& skill);

}  // namespace metier::app
