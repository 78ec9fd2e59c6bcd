#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <vector>

#include "arm_figures.hpp"
#include "metier/base/error.hpp"
#include "metier/discovery/search.hpp"
#include "metier/skill_client/skill_finder.hpp"

namespace metier::app {

/// A skill, as its server's address space tells.
struct SurveyedSkill {
    skill_client::SkillAddress address;
    std::vector<std::string> types;  ///< its own, and those that it is derived from
    ArmFigures arm{};                ///< that it moves
};

struct SurveyedServer {
    discovery::FoundServer server;
    Result<std::vector<SurveyedSkill>> skills;  ///< those that were wanted
};

/// Whether anything but its address and types is to be asked about a skill. Any thread.
using IsWanted = std::function<bool(const SurveyedSkill&)>;

/// Asks servers for their skills, many at the same time. Whoever has not answered everything
/// within `limit` has an error instead.
/// Threads: any; waits, about a second longer than `limit` for each 32 servers at most.
std::vector<SurveyedServer> survey(const std::vector<discovery::FoundServer>& servers,
                                   const IsWanted& is_wanted,
                                   std::chrono::milliseconds limit = std::chrono::seconds(2));

/// Whether a skill is of a type, with or without its ending "Type", or of one derived from it; or
/// a composed skill of that name.
bool isA(const SurveyedSkill& skill, const std::string& type);

}  // namespace metier::app
