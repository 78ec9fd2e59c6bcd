#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "metier/server/skill_survey.hpp"

namespace metier::server {

/// A figure of an arm, and how it is known.
struct ToldFigure {
    std::optional<double> value{};
    /// Who published it, or why nobody does: "of iiwa, opc.tcp://..."; empty: the skill's own
    /// server.
    std::string note;
};

/// What a skill's arms can do.
struct ToldFigures {
    ToldFigure reach;    ///< [m]
    ToldFigure payload;  ///< [kg]
};

/// Figures of the arm that a skill moves by itself or, for a skill that runs others, of the arms
/// that those move, over as many servers as it takes; the least of them.
///
/// What an arm does not publish, or a server has that was not asked, leaves the figure unknown.
/// \param servers all that were asked; \param server, skill which of them, both in range
/// Threads: any; pure. A circle of skills ends it no later than each was looked at once.
ToldFigures figuresOf(const std::vector<SurveyedServer>& servers, std::size_t server,
                      std::size_t skill);

/// Whether a skill is a candidate for a task, and why.
struct Verdict {
    bool fits = true;
    /// One for each wish: "reach 0.85 m >= 0.5 m", with the note in brackets.
    std::vector<std::string> reasons;
};

/// Whether an arm has at least the figures that are wished. What is unknown does not fit.
Verdict judge(const ArmFigures& wishes, const ToldFigures& figures);

}  // namespace metier::server
