#pragma once

#include <cstddef>
#include <vector>

#include "candidate.hpp"
#include "skill_survey.hpp"

namespace metier::app {

/// What a skill's arm can do: the arm that it moves by itself or, for a skill that runs others, the
/// arms that those move, over as many servers as it takes; the least of them.
///
/// What an arm does not tell, or what a server tells that was not asked, leaves the figure unknown.
/// \param servers all that were asked; \param server, skill which of them, both in range
/// Threads: any; pure. A circle of skills ends it no later than each was looked at once.
ToldFigures figuresOf(const std::vector<SurveyedServer>& servers, std::size_t server,
                      std::size_t skill);

}  // namespace metier::app
