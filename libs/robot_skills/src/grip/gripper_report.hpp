#pragma once

#include <string>

#include "metier/skill/skill.hpp"

namespace metier::robot_skills {

/// Answer of Check of a skill that moves no arm.
inline skill::CheckReport gripperReport(const Result<void>& allowed) {
    skill::CheckReport report{.possible = allowed.has_value(), .ends_known = true};
    if (!allowed) {
        report.reason = allowed.error().message;
        report.code = toString(allowed.error().code);
        report.first_failing_fraction = 0.0;
    }
    return report;
}

}  // namespace metier::robot_skills
