#pragma once

#include "commands.hpp"
#include "metier/link/stop_signal.hpp"
#include "metier/skill/value.hpp"
#include "owner_options.hpp"
#include "servers.hpp"

namespace metier::app {

/// Options of a command that runs a skill.
struct SkillRun {
    double timeout = 60.0;  ///< halted after that [s]
    OwnerOptions owner{};
    bool json = false;    ///< prints the result as JSON
    std::string records;  ///< where runs at servers of other makers are recorded; empty: nowhere
};

/// Starts the skill, shows its transitions on standard error, waits for its end and prints its
/// result. Ctrl-C halts it.
/// \param signal made before all threads
Exit runSkill(const link::StopSignal& signal, OpenSkill& open, const skill::ValueMap& values,
              const SkillRun& run);

}  // namespace metier::app
