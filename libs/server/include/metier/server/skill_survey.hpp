#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "metier/base/error.hpp"
#include "metier/client/lack.hpp"
#include "metier/client/skill_finder.hpp"
#include "metier/client/skill_references.hpp"
#include "metier/opcua/search.hpp"
#include "metier/server/identity.hpp"

namespace metier::server {

/// Figures of an arm, published or wished, as far as they are known.
struct ArmFigures {
    /// Farthest distance of the flange from axis 2 [m]; none: unknown, or no wish.
    std::optional<double> reach{};
    /// Greatest mass at the flange [kg]; none: unknown, or no wish.
    std::optional<double> payload{};
};

/// A property of a skill type, such as its control frequency.
struct TypeFact {
    /// BrowseName.
    std::string name;
    /// Value, a number in `unit`.
    std::variant<bool, double, std::string> value;
    /// Symbol of the unit; empty: none.
    std::string unit;
};

/// A skill as published in its server's address space.
struct SurveyedSkill {
    /// Place in its server.
    client::SkillAddress address;
    /// BrowseNames of its own type, and of those from which it is derived.
    std::vector<std::string> types;
    /// Purposes: identifiers of dictionary entries, its own, then those of its types.
    std::vector<std::string> terms{};
    /// Properties of its types below SkillType; the nearest first.
    std::vector<TypeFact> properties{};
    /// Skills that it runs; empty: it runs none, or does not publish them.
    std::vector<client::SkillUse> uses{};
    /// Figures of the arm that it moves itself.
    ArmFigures arm{};
    /// Things that a run of it cannot have, since its server is of another maker.
    std::vector<client::Lack> lacks{};
};

/// A server that was asked for its skills.
struct SurveyedServer {
    /// The server as it was found.
    opcua::FoundServer server;
    /// Its skills, or the reason why it did not answer.
    Result<std::vector<SurveyedSkill>> skills;
};

/// Asks servers for their skills, many at the same time. A server that has not answered completely
/// within `limit` gets an error instead.
/// \param security certificate and user for the connections
/// \return one entry for each server, in the same order
/// Threads: any; waits, at most about a second longer than `limit` for each 32 servers.
std::vector<SurveyedServer> survey(const std::vector<opcua::FoundServer>& servers,
                                   const ConnectionSecurity& security,
                                   std::chrono::milliseconds limit = std::chrono::seconds(2));

/// Whether a skill is of a type, written with or without the ending "Type", or of a derived one; or
/// is a composed skill of that name. Threads: any; pure.
bool isA(const SurveyedSkill& skill, const std::string& type);

/// Finds the term of a skill that a wish names, by its whole identifier,
/// "urn:metier:dictionary:grasp", or by the last part of it. Capitals do not matter; in the last
/// part "-", "_", spaces and the word "and" do not matter either: "Pick place" matches
/// "pick-and-place". Nothing if there is none.
std::optional<std::string> termOf(const SurveyedSkill& skill, const std::string& wish);

}  // namespace metier::server
