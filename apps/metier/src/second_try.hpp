#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "command_identity.hpp"
#include "metier/client/skill_handle.hpp"

namespace metier::app {

/// Trials that may take up by themselves what failed, as those of a demo: their cell is virtual.
///
/// Threading: one thread per handle.

/// Resets a skill that is Halted, again until it is Ready or `longest` has passed: an arm may still
/// brake.
/// Errors: why the last Reset was refused; those of the connection.
Result<void> resetUntilReady(client::SkillHandle& skill, std::chrono::milliseconds longest);

/// The same for every Halted skill of those servers: a watchdog, or a lost link, has halted them
/// besides the skill that used them. A server that does not answer is left out.
void resetAllHalted(const CommandIdentity& identity, const std::vector<std::string>& urls,
                    std::chrono::milliseconds longest);

}  // namespace metier::app
