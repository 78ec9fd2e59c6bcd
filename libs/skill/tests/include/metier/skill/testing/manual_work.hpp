#pragma once

#include "metier/base/error.hpp"
#include "metier/skill/execution.hpp"
#include "metier/skill/lambda_skill.hpp"

namespace metier::skill::testing {

/// A skill that suspends and resumes at once, and whose work ends when the test says so: by
/// `execution`, which a start sets. It must outlive the skill.
inline SkillFunctions manualWork(Execution& execution) {
    return {.start = [&execution](const ValueMap& /*parameters*/,
                                  const Execution& started) { execution = started; },
            .suspend =
                [](const Execution& stopped) {
                    stopped.atRest();
                    return Result<void>();
                },
            .resume = [](const Execution& /*resumed*/) { return Result<void>(); }};
}

}  // namespace metier::skill::testing
