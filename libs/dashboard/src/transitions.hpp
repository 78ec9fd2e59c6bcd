#pragma once

#include <optional>
#include <string>

#include "board.hpp"
#include "metier/client/async_skill.hpp"
#include "metier/opcua/client.hpp"

namespace metier::dashboard {

/// Makes a callback that reports each transition of a skill to the board, and raises an alarm for
/// one that nobody asked for.
/// \param board must outlive the callback
client::AsyncSkill::OnTransition transitionsTo(Board& board, std::string key);

/// Alarm in an event with the fields Message, Severity and Time; nothing for other events.
std::optional<Alarm> alarmOf(const std::string& server, const opcua::EventNotice& notice);

}  // namespace metier::dashboard
