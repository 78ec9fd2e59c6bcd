#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "metier/base/error.hpp"
#include "metier/opcua/search.hpp"
#include "metier/server/identity.hpp"
#include "metier/client/skill_finder.hpp"
#include "metier/client/skill_references.hpp"

namespace metier::server {

/// Figures of an arm that a server publishes, or that are wanted of one; as far as known.
struct ArmFigures {
    std::optional<double> reach{};    ///< farthest the flange can be from axis 2 [m]
    std::optional<double> payload{};  ///< greatest mass at the flange [kg]
};

/// A skill, as its server's address space tells.
struct SurveyedSkill {
    client::SkillAddress address;
    std::vector<std::string> types;  ///< its own, and those that it is derived from
    /// Purposes: identifiers of dictionary entries, its own, then those of its types.
    std::vector<std::string> terms{};
    std::vector<client::SkillUse> uses{};
    ArmFigures arm{};  ///< of what it moves; of nothing that it uses
};

struct SurveyedServer {
    opcua::FoundServer server;
    Result<std::vector<SurveyedSkill>> skills;
};

/// Asks servers for their skills, many at the same time. Whoever has not answered everything
/// within `limit` has an error instead.
/// Threads: any; waits, about a second longer than `limit` for each 32 servers at most.
std::vector<SurveyedServer> survey(const std::vector<opcua::FoundServer>& servers,
                                   const ConnectionSecurity& security,
                                   std::chrono::milliseconds limit = std::chrono::seconds(2));

/// Whether a skill is of a type, with or without its ending "Type", or of one derived from it; or
/// a composed skill of that name.
bool isA(const SurveyedSkill& skill, const std::string& type);

/// The term of a skill that a wish names: by its whole identifier, "urn:metier:dictionary:grasp",
/// or by the last part of it. Capitals do not matter, in the last part neither do "-", "_", spaces
/// and the word "and": "Pick place" is "pick-and-place". Nothing if there is none.
std::optional<std::string> termOf(const SurveyedSkill& skill, const std::string& wish);

}  // namespace metier::server
