#pragma once

#include <string>

#include "metier/client/skill_finder.hpp"
#include "metier/opcua/client.hpp"
#include "metier/server/skill_survey.hpp"

namespace metier::server {

/// Figures of the arm that a skill moves; none if it moves none. Waits for the server.
ArmFigures figuresOfArm(opcua::Client& client, const client::SkillAddress& skill);

/// Whether an arm has at least the figures that are wanted; what is unknown is not enough.
bool isAtLeast(const ArmFigures& wanted, const ArmFigures& there);

/// Text of what is wanted: " with a reach of 0.5 m and a payload of 3 kg"; empty if nothing is.
std::string textOf(const ArmFigures& wanted);

}  // namespace metier::server
