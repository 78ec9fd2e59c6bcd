#pragma once

#include <optional>
#include <string>

#include "board.hpp"
#include "metier/client/async_skill.hpp"
#include "metier/opcua/client.hpp"

namespace metier::dashboard {

/// Has the board told of each transition of a skill, and of an alarm for one that nobody called.
/// \param board must outlive what it is given to
client::AsyncSkill::OnTransition transitionsTo(Board& board, std::string key);

/// What an event with the fields Message, Severity and Time tells; nothing if it is not one.
std::optional<Alarm> alarmOf(const std::string& server, const opcua::EventNotice& notice);

}  // namespace metier::dashboard
