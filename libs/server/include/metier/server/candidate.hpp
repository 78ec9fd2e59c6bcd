#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "metier/server/skill_survey.hpp"

namespace metier::server {

/// A figure of an arm, with its source.
struct KnownFigure {
    /// The figure; none: unknown.
    std::optional<double> value{};
    /// Publisher of the figure, or the reason why it is unknown: "of iiwa, opc.tcp://..."; empty:
    /// the skill's own server.
    std::string note;
};

/// Reach and payload of a skill's arms.
struct KnownFigures {
    /// Reach of the arm [m].
    KnownFigure reach;
    /// Payload of the arm [kg].
    KnownFigure payload;
};

/// Figures of the arm that a skill moves itself or, for a skill that runs others, the least figures
/// of all arms that those move, across servers.
///
/// A figure is unknown if one of the arms does not publish it, or if its server was not asked.
/// \param servers all servers that were asked
/// \param server, skill indices of the skill, both in range
/// Threads: any; pure. Skills that use each other in a circle are looked at once each.
KnownFigures figuresOf(const std::vector<SurveyedServer>& servers, std::size_t server,
                       std::size_t skill);

/// Judgement whether a skill fits a task, with the reasons.
struct Verdict {
    /// Whether every wish is met.
    bool fits = true;
    /// One reason per wish: "reach 0.85 m >= 0.5 m", with the note in brackets.
    std::vector<std::string> reasons;
};

/// Checks that an arm has at least the wished figures. An unknown figure does not fit; no wish fits
/// every arm. Threads: any; pure.
Verdict judge(const ArmFigures& wishes, const KnownFigures& figures);

}  // namespace metier::server
