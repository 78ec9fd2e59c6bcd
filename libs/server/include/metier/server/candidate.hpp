#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "metier/server/skill_survey.hpp"

namespace metier::server {

/// A figure of an arm, and how it is known.
struct KnownFigure {
    std::optional<double> value{};
    /// Who published it, or why nobody does: "of iiwa, opc.tcp://..."; empty: the skill's own
    /// server.
    std::string note;
};

/// Reach and payload of a skill's arms.
struct KnownFigures {
    KnownFigure reach;    ///< [m]
    KnownFigure payload;  ///< [kg]
};

/// Figures of the arm that a skill moves by itself or, for a skill that runs others, of the arms
/// that those move, over as many servers as it takes; the least of them.
///
/// A figure is unknown if one of the arms does not publish it, or its server was not asked.
/// \param servers all that were asked; \param server, skill which of them, both in range
/// Threads: any; pure. A circle of skills ends it no later than each was looked at once.
KnownFigures figuresOf(const std::vector<SurveyedServer>& servers, std::size_t server,
                       std::size_t skill);

/// Whether a skill is a candidate for a task, and why.
struct Verdict {
    bool fits = true;
    /// One for each wish: "reach 0.85 m >= 0.5 m", with the note in brackets.
    std::vector<std::string> reasons;
};

/// Whether an arm has at least the figures that are wished. What is unknown does not fit.
Verdict judge(const ArmFigures& wishes, const KnownFigures& figures);

}  // namespace metier::server
