#pragma once

#include <chrono>
#include <csignal>
#include <string>
#include <vector>

#include "metier/skill/state.hpp"
#include "metier/skill/value.hpp"

namespace metier::system_tests {

/// State of a skill when its commander is struck. Suspending and halting: braking.
enum class AtFault { ready, running, suspended, suspending, halting };

/// Order for `metier_commander`: take control, bring the skill to a state, report that, wait for
/// signals.
struct CommanderOrder {
    std::string url;
    std::string skill;
    std::chrono::milliseconds lease{};
    skill::OwnerLossAction on_loss = skill::OwnerLossAction::skill_default;
    AtFault at = AtFault::ready;
    std::chrono::milliseconds delay{};  ///< from Start until it suspends, halts or reports
    skill::ValueMap parameters{};       ///< numbers and lists of numbers
};

std::vector<std::string> argumentsOf(const CommanderOrder& order);
/// Throws if they are not those of an order.
CommanderOrder orderFrom(const std::vector<std::string>& arguments);

inline constexpr int kFallSilent = SIGUSR1;    ///< send no more heartbeats
inline constexpr int kCloseSession = SIGUSR2;  ///< without giving control back
inline constexpr int kCommandAgain = SIGHUP;   ///< try every command, one after the other

}  // namespace metier::system_tests
